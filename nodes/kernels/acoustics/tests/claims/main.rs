//! Tests of the virtual acoustic measurement.

mod computed_records;
mod crystals;
mod dispersion;
mod instrument;
mod modes;
mod pick_coverage;
mod picks;
mod records;
mod sample;
mod stated_errors;
mod supercell;
mod time_of_flight;
