//! Explicit probe: stiffness from the stress change under a small strain, with the whole contact law.
//!
//! - [`strain_probe()`]: all six columns, with the settings [`StrainProbe`]
//! - [`Relaxation`]: brings grains to rest in a fixed cell

mod column;
mod relaxation;
mod settings;
mod strain_probe;

pub use column::ProbeColumn;
pub use relaxation::Relaxation;
pub use settings::StrainProbe;
pub use strain_probe::{StrainProbeResult, strain_probe};
