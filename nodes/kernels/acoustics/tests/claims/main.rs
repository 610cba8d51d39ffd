//! Claims about the virtual acoustic measurement.

mod repeat;
mod sample;
mod standing;
