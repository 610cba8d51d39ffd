//! The state of the sample, as the scaling laws take it.

use crate::calibration::{Calibration, NetworkState, Outside, RelaxationCalibration, SCATTERED, Scatter};
use crate::conditions::{
    Conditions, LARGEST_SPREAD, STATE_INPUTS, UNKNOWN_SIZE_SPREAD, UNKNOWN_STRESS_RATIO,
};
use crate::error::EmtError;
use crate::invariants::Invariants;
use crate::moduli::MODULI;
use crate::probe::Probe;
use grainlab_core::Material;
use grainlab_core::notes::Note;
use nalgebra::{SVector, Vector2};

/// Step of the derivatives by the inputs of the state, as in [`crate::propagation`].
const STEP: f64 = 1e-5;

/// Number of equally probable spreads that stand for one that is not known.
const SPREADS: u32 = 16;

/// The state of a sample in the units of the scaling laws.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// E*^⅔ p^⅓, Pa.
    pub(super) unit: f64,
    pub(super) laws: NetworkState,
    pub(super) inputs: Vec<UncertainInput>,
    /// True if q/p was given.
    pub(super) stress_known: bool,
    pub(super) sizes_known: bool,
    /// Levels of the scatter of samples of this size in this state, before their dependence on z.
    pub(super) scatter: [Scatter; 2],
    pub(super) probe: Probe,
    pub(super) outside: Vec<Outside>,
}

/// An input of the state, and the states next to it.
#[derive(Clone, Debug)]
pub(super) struct UncertainInput {
    /// Index in [`grainlab_core::results::INFERENCE_INPUTS`].
    pub(super) at: usize,
    /// Variance, of the kind of [`Conditions::stddevs`].
    pub(super) variance: f64,
    /// ln of the unit and state of the laws, a step above and below.
    sides: [(f64, NetworkState); 2],
}

/// Derivatives by one input of the state.
pub(super) struct Slopes {
    /// Slopes of predicted less observed moduli, in units of [`State::unit`].
    pub(super) moduli: SVector<f64, MODULI>,
    /// Slopes of ε weighted by stiffness, and of k.
    pub(super) following: Vector2<f64>,
}

impl UncertainInput {
    /// At a structure, for moduli observed in units of [`State::unit`]: the moduli in this unit change with it.
    pub(super) fn slopes(
        &self,
        network: &RelaxationCalibration,
        z: f64,
        eps: f64,
        observed: &SVector<f64, MODULI>,
    ) -> Slopes {
        let [(unit_above, above), (unit_below, below)] = &self.sides;
        let moduli = |laws| SVector::<f64, MODULI>::from(invariants(network, laws, z, eps).moduli());
        let following =
            |laws| Vector2::new(network.eps_stiffness.value(z, eps, laws), network.rattlers.value(z, laws));
        let by = 0.5 / STEP;
        Slopes {
            moduli: (moduli(above) - moduli(below) + observed * (unit_above - unit_below)) * by,
            following: (following(above) - following(below)) * by,
        }
    }
}

/// Unit of the moduli, Pa, and state of the laws.
fn reduced(conditions: &Conditions, material: &Material) -> (f64, NetworkState) {
    let grains = conditions.material.as_ref().unwrap_or(material);
    let pressure = conditions.pressure.value;
    let stress_ratio = conditions.stress_ratio.unwrap_or(UNKNOWN_STRESS_RATIO).value;
    let size_spread = conditions.size_spread.unwrap_or(UNKNOWN_SIZE_SPREAD.value);
    let unit = grains.effective_young().cbrt().powi(2) * pressure.cbrt();
    (unit, NetworkState::of(pressure, grains, size_spread, stress_ratio))
}

fn invariants(network: &RelaxationCalibration, laws: &NetworkState, z: f64, eps: f64) -> Invariants {
    Invariants {
        ln_theta: network.theta.value(z, laws),
        ln_shear: network.shear.value(z, laws),
        dilatation: network.dilatation.value(z, eps, laws),
        voigt: network.voigt.value(z, eps, laws),
        harmonic: network.harmonic.value(z, eps, laws),
    }
}

impl State {
    pub(super) fn of(
        conditions: &Conditions,
        (grains, probe): (Option<u32>, Probe),
        network: &RelaxationCalibration,
        calibration: &Calibration,
    ) -> Self {
        let (unit, laws) = reduced(conditions, calibration.material());
        let material = conditions.material.as_ref().unwrap_or(calibration.material());
        let outside = network.reach.outside(conditions.pressure.value / material.effective_young(), &laws);
        let stddevs = conditions.stddevs(calibration.material());
        let input = |at: usize| {
            let side = |by: f64| {
                let (unit, laws) =
                    reduced(&conditions.moved(at, by, calibration.material())?, calibration.material());
                Some((unit.ln(), laws))
            };
            let sides = [side(STEP)?, side(-STEP)?];
            Some(UncertainInput { at: MODULI + at, variance: stddevs[at].powi(2), sides })
        };
        let inputs = (0..STATE_INPUTS).filter_map(input).collect();
        let growth: f64 = outside.iter().map(Outside::growth).product();
        let grown = |laws: &NetworkState| RelaxationCalibration::growth(&network.scatter_by_state, laws);
        let of_state = match conditions.size_spread {
            Some(_) => grown(&laws),
            None => {
                let mean = |all: [f64; SCATTERED], i: u32| {
                    let spread = LARGEST_SPREAD * (f64::from(i) + 0.5) / f64::from(SPREADS);
                    let one = grown(&NetworkState { size_variance: spread * spread, ..laws });
                    std::array::from_fn(|j| all[j] + one[j] / f64::from(SPREADS))
                };
                (0..SPREADS).fold([0.0; SCATTERED], mean)
            }
        };
        Self {
            unit,
            laws,
            inputs,
            stress_known: conditions.stress_ratio.is_some(),
            sizes_known: conditions.size_spread.is_some(),
            probe,
            scatter: network.scatter_of(grains, &of_state).map(|level| level * growth),
            outside,
        }
    }

    /// The first quantity that is too far from the packings of the calibration, if any, as an error.
    pub(super) fn within_reach(&self, calibration: &str) -> Result<(), EmtError> {
        self.outside.iter().find(|o| o.is_too_far()).map_or(Ok(()), |o| Err(too_far(o, calibration)))
    }

    pub(super) fn invariants(&self, network: &RelaxationCalibration, z: f64, eps: f64) -> Invariants {
        invariants(network, &self.laws, z, eps)
    }
}

pub(in crate::models) fn too_far(outside: &Outside, calibration: &str) -> EmtError {
    let Outside { quantity, value, range: [low, high], .. } = *outside;
    Note::too_far(quantity, calibration.to_owned(), value, low, high).into()
}
