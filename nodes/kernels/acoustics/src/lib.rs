//! Virtual acoustic measurement of a packing.
//!
//! Three ways to measure the speed of a wave, which share [`ray`] (where a wave goes and how the grains move), [`curve`]
//! (a speed at several wavelengths, extrapolated to long ones) and [`participation`] (the mass that moves with a wave):
//!
//! - [`dispersion`]: frequencies of the acoustic modes of the frozen contact network at Bloch wave vectors of any length
//! - [`standing`]: the packing, repeated along the path, starts with the velocity of a plane wave; how it rings
//! - [`flight`]: a burst is sent through the packing, repeated along the path; when it arrives
//!
//! [`mod@measure`] does any of them along a whole set of rays ([`survey`]), through an [`instrument`] with noise of its own.

pub mod arrival;
mod bloch;
mod burst;
mod cluster;
pub mod curve;
pub mod dispersion;
pub mod error;
pub mod flight;
pub mod instrument;
mod lattice;
mod line;
mod meaning;
pub mod measure;
mod modes;
mod noise;
pub mod participation;
mod passage;
mod pick;
pub mod ray;
pub mod repeat;
mod resonance;
mod ringing;
mod row;
mod sample;
mod shot;
mod slab;
mod solve;
mod spectrum;
pub mod standing;
mod subspace;
pub mod survey;
#[cfg(test)]
mod tests_support;
mod tone;
pub mod trace;
mod travel;

pub use curve::Curve;
pub use error::AcousticsError;
pub use instrument::Instrument;
pub use measure::{Measurement, Settings, Way, measure, with_speed_noise};
pub use participation::Participation;
pub use ray::Ray;
pub use repeat::{Repeated, repeated};
pub use survey::{Modes, Survey};
pub use trace::Trace;
