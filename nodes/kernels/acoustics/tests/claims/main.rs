//! Claims about the virtual acoustic measurement.

mod sample;
