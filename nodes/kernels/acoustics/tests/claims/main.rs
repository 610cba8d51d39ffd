//! Tests of the virtual acoustic measurement.

mod chain;
mod crystals;
mod dispersion;
mod instrument;
mod modes;
mod picks;
mod sample;
mod standing_wave;
mod stated_errors;
mod supercell;
mod time_of_flight;
