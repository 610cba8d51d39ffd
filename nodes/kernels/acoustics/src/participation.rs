//! The mass that moves with a wave.
//!
//! Rattlers do not, and a grain that turns freely about its two contacts moves with less than its mass.

use grains::Mat3;

/// Mass of a packing that moves with long waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Participation {
    /// Effective density of a motion p: pᵀ ρ p, kg/m³.
    pub density: Mat3,
    /// Density of all grains, kg/m³.
    pub bulk: f64,
    /// Grains that carry no force.
    pub rattlers: u32,
    /// Motions that meet no resistance, those of rattlers left out.
    pub floppy: u32,
}

impl Participation {
    /// Mean over directions, kg/m³.
    pub fn mean(&self) -> f64 {
        self.density.trace() / 3.0
    }
}
