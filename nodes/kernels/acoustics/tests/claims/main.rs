//! Claims about the virtual acoustic measurement.

mod crystals;
mod dispersion;
mod sample;
