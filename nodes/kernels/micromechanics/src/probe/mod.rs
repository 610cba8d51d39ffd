//! Explicit probe: stiffness by straining the packing a little with the whole contact law and reading the stress.
//!
//! - [`strain_probe()`]: all six columns, with the settings [`StrainProbe`]
//! - [`amplitude_sweep()`]: over which strains the response is linear
//! - [`Relaxation`]: brings grains to rest in a cell that does not move

mod amplitude_sweep;
mod column;
mod relaxation;
mod settings;
mod strain_probe;

pub use amplitude_sweep::{AmplitudeSweep, amplitude_sweep};
pub use column::ProbeColumn;
pub use relaxation::Relaxation;
pub use settings::{DifferenceScheme, StrainProbe};
pub use strain_probe::{StrainProbeResult, strain_probe};
