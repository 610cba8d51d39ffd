//! The tables of La Ragione & Magnanimo, Phys. Rev. E 85, 031304 (2012), and simulated packings compared with them.
//!
//! - [`PAPER`]: Tables I, II and III as printed
//! - [`Quantity`]: what is compared, with its value in the paper and in a packing
//! - [`compare`]: mean and standard error over seeds, and the difference from the paper in units of its error
//! - [`inversion`]: every model judged by the counted truth, with each of the three γ/Δ
//! - [`distance()`]: how far packings are from the paper, in one number
//! - [`claims`]: the paper's statements in words, and the goals of the reproduction

pub mod claims;
mod compare;
mod distance;
pub mod inversion;
mod quantity;
mod sample;
mod scatter;
mod tables;

pub use compare::{Comparison, compare};
pub use distance::{DISTANCE, distance};
pub use grainlab_page::Mean;
pub use quantity::{Printed, Quantity};
pub use sample::{Observed, States};
pub use tables::{PAPER, PRESSURE, PRESSURES, REFERENCE_SOLID_FRACTION, SAMPLES, Sample, State};
