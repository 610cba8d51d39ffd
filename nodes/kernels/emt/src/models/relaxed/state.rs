//! The state of the sample, as the scaling laws take it.

use crate::calibration::{Calibration, RelaxationCalibration};
use crate::conditions::Conditions;
use crate::invariants::Invariants;

/// The state of a sample in the units of the scaling laws.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    /// E*^⅔ p^⅓, Pa.
    pub(super) unit: f64,
    /// ln(φ/φ0), and its standard deviation.
    pub(super) ln_phi: [f64; 2],
    /// ln of p/E* over that of the calibration's reference.
    pub(super) ln_p: f64,
    /// Whether φ was given.
    pub(super) phi_known: bool,
    /// Variance of the scatter of samples of this size over that of the packings of the calibration.
    pub(super) variance_factor: f64,
}

impl State {
    pub(super) fn of(
        conditions: &Conditions,
        grains: Option<u32>,
        network: &RelaxationCalibration,
        calibration: &Calibration,
    ) -> Self {
        let own = calibration.material();
        let young = conditions.material.as_ref().unwrap_or(own).effective_young();
        let pressure = conditions.pressure.value;
        let [mean, spread] = network.solid_fraction;
        let ln_phi = match conditions.solid_fraction {
            Some(phi) => [(phi.value / mean).ln(), phi.stddev / phi.value],
            None => [0.0, spread / mean],
        };
        Self {
            unit: young.cbrt().powi(2) * pressure.cbrt(),
            ln_phi,
            ln_p: (pressure / network.pressure * (own.effective_young() / young)).ln(),
            phi_known: conditions.solid_fraction.is_some(),
            variance_factor: network.variance_factor(grains),
        }
    }

    pub(super) fn invariants(&self, network: &RelaxationCalibration, z: f64, eps: f64) -> Invariants {
        Invariants {
            ln_theta: network.theta.value(z, self.ln_phi[0], self.ln_p),
            ln_shear: network.shear.value(z, self.ln_phi[0], self.ln_p),
            dilatation: network.dilatation.value(z) * eps,
            voigt: network.voigt.value(z) * eps,
            harmonic: network.harmonic.value(z) * eps,
        }
    }
}
