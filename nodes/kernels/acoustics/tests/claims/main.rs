//! Claims about the virtual acoustic measurement.

mod chain;
mod crystals;
mod dispersion;
mod flight;
mod instrument;
mod picks;
mod repeat;
mod sample;
mod standing;
