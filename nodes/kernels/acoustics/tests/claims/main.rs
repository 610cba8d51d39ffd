//! Claims about the virtual acoustic measurement.

mod chain;
mod crystals;
mod dispersion;
mod repeat;
mod sample;
mod standing;
