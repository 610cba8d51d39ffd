//! Tests of the virtual acoustic measurement.

mod crystals;
mod dispersion;
mod golden_packing;
mod instrument;
mod modes;
mod picks;
mod records;
mod sample;
mod stated_errors;
mod supercell;
mod time_of_flight;
