//! Claims about the virtual acoustic measurement.

mod crystals;
mod dispersion;
mod repeat;
mod sample;
mod standing;
