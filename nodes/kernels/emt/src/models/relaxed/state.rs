//! The state of the sample, as the scaling laws take it.

use crate::calibration::{Calibration, NetworkState, Outside, RelaxationCalibration, SCATTERED};
use crate::conditions::Conditions;
use crate::error::EmtError;
use crate::invariants::Invariants;

/// The state of a sample in the units of the scaling laws.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// E*^⅔ p^⅓, Pa.
    pub(super) unit: f64,
    /// The state in the laws.
    pub(super) laws: NetworkState,
    /// Whether q/p was given.
    pub(super) stress_known: bool,
    /// Whether the sizes were given.
    pub(super) sizes_known: bool,
    /// Variances of the scatter in this state and of samples of this size over those of the calibration.
    pub(super) variance_factors: [f64; SCATTERED],
    /// What is outside the packings of the calibration.
    pub(super) outside: Vec<Outside>,
}

impl State {
    pub(super) fn of(
        conditions: &Conditions,
        grains: Option<u32>,
        network: &RelaxationCalibration,
        calibration: &Calibration,
    ) -> Self {
        let material = conditions.material.as_ref().unwrap_or(calibration.material());
        let young = material.effective_young();
        let pressure = conditions.pressure.value;
        let stress_ratio = conditions.stress_ratio.map_or(0.0, |ratio| ratio.value);
        let laws = NetworkState::of(pressure, material, conditions.size_spread.unwrap_or(0.0), stress_ratio);
        let outside = network.reach.outside(pressure / young, &laws);
        let growth: f64 = outside.iter().map(Outside::growth).product();
        let of_sample = network.variance_factors(grains);
        let of_state = RelaxationCalibration::growth(&network.scatter_by_state, &laws);
        Self {
            unit: young.cbrt().powi(2) * pressure.cbrt(),
            laws,
            stress_known: conditions.stress_ratio.is_some(),
            sizes_known: conditions.size_spread.is_some(),
            variance_factors: std::array::from_fn(|i| of_sample[i] * of_state[i] * growth),
            outside,
        }
    }

    /// The first quantity that is too far from the packings of the calibration, if any, as an error.
    pub(super) fn within_reach(&self, calibration: &str) -> Result<(), EmtError> {
        self.outside.iter().find(|o| o.is_too_far()).map_or(Ok(()), |o| Err(too_far(o, calibration)))
    }

    pub(super) fn invariants(&self, network: &RelaxationCalibration, z: f64, eps: f64) -> Invariants {
        Invariants {
            ln_theta: network.theta.value(z, &self.laws),
            ln_shear: network.shear.value(z, &self.laws),
            dilatation: network.dilatation.value(z, eps, &self.laws),
            voigt: network.voigt.value(z, eps, &self.laws),
            harmonic: network.harmonic.value(z, eps, &self.laws),
        }
    }
}

/// The error of a quantity that is too far from the packings of the calibration.
pub(super) fn too_far(outside: &Outside, calibration: &str) -> EmtError {
    let Outside { quantity, value, range: [low, high], .. } = *outside;
    EmtError::TooFar { quantity, value, low, high, calibration: calibration.to_owned() }
}
