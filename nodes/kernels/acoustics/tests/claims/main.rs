//! Claims about the virtual acoustic measurement.

mod chain;
mod crystals;
mod dispersion;
mod time_of_flight;
mod instrument;
mod picks;
mod supercell;
mod sample;
mod standing_wave;
