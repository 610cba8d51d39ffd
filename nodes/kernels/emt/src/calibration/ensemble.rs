//! Packings that a calibration is learned from.

use crate::conditions::{Conditions, Gamma, GammaSource, Measured};
use crate::moduli::Moduli;
use crate::observation::Observation;
use grainlab_core::Material;
use grainlab_core::results::StrainRatios;

/// One packing: its moduli, and its structure as counted.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// How it was prepared. Packings of one preparation are left out together when the models are judged.
    pub preparation: String,
    /// Which of them it is: states of the same packing at several pressures share it.
    pub packing: String,
    /// Number of grains.
    pub grains: u32,
    /// Material of the grains.
    pub material: Material,
    /// Pressure, Pa.
    pub pressure: f64,
    /// Solid fraction φ.
    pub solid_fraction: f64,
    /// All six moduli, Pa.
    pub moduli: Moduli,
    /// γ/Δ.
    pub gamma: StrainRatios,
    /// Coordination number of all grains.
    pub k: f64,
    /// Coordination number without rattlers.
    pub z: f64,
    /// Anisotropy of the number of contacts.
    pub eps: f64,
    /// The same weighted by contact stiffness.
    pub eps_stiffness: f64,
}

impl Sample {
    /// What an experimenter who knows this γ/Δ observes of it.
    pub fn observation(&self, gamma: GammaSource) -> Observation {
        let conditions = Conditions {
            gamma: Gamma::of(&self.gamma, gamma),
            solid_fraction: Some(Measured::exact(self.solid_fraction)),
            material: Some(self.material),
            ..Conditions::at(self.pressure)
        };
        Observation { grains: Some(self.grains), ..Observation::new(self.moduli, conditions) }
    }

    /// Whether every number is one.
    pub(super) fn is_finite(&self) -> bool {
        let numbers = [
            self.pressure,
            self.solid_fraction,
            self.k,
            self.z,
            self.eps,
            self.eps_stiffness,
            self.material.shear_modulus,
            self.material.poisson_ratio,
        ];
        numbers.iter().all(|v| v.is_finite())
            && self.moduli.values().iter().all(|m| m.is_some_and(|m| m.is_finite() && m > 0.0))
    }
}
