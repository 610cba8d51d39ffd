//! Claims about the virtual acoustic measurement.

mod flight;
mod instrument;
mod picks;
mod repeat;
mod sample;
