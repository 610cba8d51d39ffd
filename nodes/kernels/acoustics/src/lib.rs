//! Virtual acoustic measurement of a packing.
//!
//! Two methods measure the speed of a wave:
//!
//! - [`dispersion`]: frequencies of the acoustic modes of the frozen contact network at Bloch wave vectors of any
//!   length
//! - [`time_of_flight`]: arrival of a burst that is sent through a supercell
//!
//! They share `ray` (direction of propagation and polarizations), `curve` (speeds at several wavelengths, extrapolated
//! to long waves), `backbone` (the grains that carry waves, and their effective density) and `supercell` (the packing,
//! repeated along a path).
//!
//! [`measure`](fn@measure) applies a method to a set of rays (`survey`), through an `instrument` with noise.

// The computed records of the tests name this crate.
#[cfg(test)]
extern crate self as grainlab_acoustics;

mod backbone;
mod curve;
pub mod dispersion;
mod effective_density;
mod error;
mod instrument;
mod left_out;
mod measure;
mod noise;
mod ray;
pub mod record;
mod sample;
mod settings;
mod supercell;
mod survey;
pub mod time_of_flight;
mod trace;

pub use curve::{DispersionCurve, DispersionPoint};
pub use effective_density::EffectiveDensity;
pub use error::AcousticsError;
pub use instrument::{Instrument, ReceiverSignals, SamplingWindow};
pub use measure::{Measurement, measure, with_speed_noise};
pub use ray::Ray;
pub use settings::{MethodSettings, Settings};
pub use supercell::{Supercell, supercell};
pub use survey::{Modes, Survey};
pub use trace::{Channel, Trace};
