//! Claims about the virtual acoustic measurement.

mod chain;
mod repeat;
mod sample;
mod standing;
