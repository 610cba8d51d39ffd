//! Packings that a calibration is learned from.

use crate::conditions::{Conditions, Measured, StrainRatio, StrainRatioSource};
use crate::moduli::Moduli;
use crate::observation::Observation;
use grainlab_core::Material;
use grainlab_core::results::StrainRatios;

/// One packing: its moduli, and its structure counted from the contacts.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationSample {
    /// How it was prepared. Packings of one preparation are left out together when the models are tested.
    pub preparation: String,
    /// Name of the packing: states of the same packing at several pressures share it.
    pub packing: String,
    /// Number of grains.
    pub grains: u32,
    /// Material of the grains.
    pub material: Material,
    /// Pressure, Pa.
    pub pressure: f64,
    /// Solid fraction φ.
    pub solid_fraction: f64,
    /// (σ_33 − (σ_11 + σ_22)/2)/p.
    pub stress_ratio: f64,
    /// Standard deviation of the radii over their mean.
    pub size_spread: f64,
    /// All six moduli, Pa.
    pub moduli: Moduli,
    /// γ/Δ.
    pub gamma: StrainRatios,
    /// Coordination number of all grains.
    pub k: f64,
    /// Coordination number without rattlers.
    pub z: f64,
    /// Contact anisotropy ε.
    pub eps: f64,
    /// ε weighted by contact stiffness.
    pub eps_stiffness: f64,
}

impl CalibrationSample {
    /// The observation with this γ/Δ.
    pub fn observation(&self, gamma: StrainRatioSource) -> Observation {
        let conditions = Conditions {
            gamma: StrainRatio::of(&self.gamma, gamma),
            solid_fraction: Some(Measured::exact(self.solid_fraction)),
            stress_ratio: Some(Measured::exact(self.stress_ratio)),
            size_spread: Some(self.size_spread),
            material: Some(self.material),
            ..Conditions::at(self.pressure)
        };
        Observation { grains: Some(self.grains), ..Observation::new(self.moduli, conditions) }
    }

    /// p/E*.
    pub(super) fn reduced_pressure(&self) -> f64 {
        self.pressure / self.material.effective_young()
    }

    /// Whether every number is finite and every modulus positive.
    pub(super) fn is_finite(&self) -> bool {
        let numbers = [
            self.pressure,
            self.solid_fraction,
            self.stress_ratio,
            self.size_spread,
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

/// Lowest and highest.
pub(super) fn bounds(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}
