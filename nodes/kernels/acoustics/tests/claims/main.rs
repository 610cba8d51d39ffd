//! Claims about the virtual acoustic measurement.

mod crystals;
mod dispersion;
mod flight;
mod instrument;
mod picks;
mod repeat;
mod sample;
mod standing;
