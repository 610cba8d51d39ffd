//! The moduli of a relaxed contact network, without γ/Δ.
//!
//! The scalars of the stiffness depend on the coordination number z, on p/E*, on k_t/k_n and on the sizes. Its two deviators
//! are linear in ε and in q/p, with factors that grow as the network approaches its isostatic point. The harmonic part depends on the fourth-order
//! fabric and hardly on ε (see [`crate::Invariants`]). Packings of the same structure still differ; their scatter is
//! known as a covariance of these five numbers, and the estimate is the generalised least-squares one: for a linear
//! model, the most probable one with a flat prior for z and ε. k and the ε weighted by contact stiffness follow from z,
//! ε and the residual of the moduli.
//!
//! The constants are learned from packings ([`crate::Calibration`]); only the form of the laws is derived.

mod fit;
mod network_likelihood;
mod scan;
mod state;

use crate::calibration::{Calibration, Outside, Reach, RelaxationCalibration};
use crate::checks::FALSE_ALARM;
use crate::conditions::Conditions;
use crate::domain::{Domain, Fitted, by_quantity, outside_fitted};
use crate::error::EmtError;
use crate::likelihood::Likelihood;
use crate::model::Model;
use crate::moduli::{Moduli, Modulus};
use crate::normal;
use crate::observation::Observation;
use crate::point_estimate::{Misfit, PointEstimate};
use crate::probe::Probe;
use fit::{Data, Fit};
use grainlab_core::notes::Note;
use grainlab_core::results::{InferredQuantity, Microstructure};
use network_likelihood::NetworkLikelihood;
use state::State;
pub(super) use state::too_far;

/// The relaxed network: model `relaxed`.
#[derive(Clone, Copy, Debug)]
pub struct Relaxed;

const NAME: &str = "relaxed";

/// Standard deviation of ε above which ε counts as undetermined: larger than the ε of any packing.
const UNDETERMINED: f64 = 0.2;

/// Probability of the misfit below which an estimate is not `ok`: the laws, and the stated errors with them, are of other packings.
const UNLIKE: f64 = 0.01;

impl Model for Relaxed {
    fn name(&self) -> &'static str {
        NAME
    }

    fn domain(&self, calibration: &Calibration) -> Domain {
        let Some(network) = calibration.network() else { return Domain::new(NAME, &[]) };
        let Reach { z, eps, pressure: reduced_pressure, stress_ratio, size_spread, .. } =
            network.reach.with_ends();
        let structure = [(InferredQuantity::Z, z), (InferredQuantity::Eps, eps)];
        let [z, eps] = network.reach.without_warning();
        let fitted = by_quantity(&[
            (InferredQuantity::Z, Fitted { range: network.reach.z, inside: z }),
            (InferredQuantity::Eps, Fitted { range: network.reach.eps, inside: eps }),
        ]);
        let size_spread = [size_spread[0].max(0.0), size_spread[1]];
        Domain {
            reduced_pressure,
            stress_ratio,
            size_spread,
            fitted,
            compares_state: true,
            ..Domain::new(NAME, &structure)
        }
    }

    fn predict(
        &self,
        structure: &Microstructure,
        conditions: &Conditions,
        calibration: &Calibration,
    ) -> Result<Moduli, EmtError> {
        let network = network(calibration)?;
        let domain = self.domain(calibration);
        let found = domain.validate(structure, conditions)?;
        let material = conditions.material.as_ref().unwrap_or(calibration.material());
        domain.validate_pressure(conditions.pressure.value, material.effective_young())?;
        let [z, eps] = [InferredQuantity::Z, InferredQuantity::Eps].map(|q| found[q as usize]);
        let state = State::of(conditions, (None, Probe::Sticking), network, calibration);
        let moduli = state.invariants(network, z, eps).moduli().map(|m| m * state.unit);
        for (modulus, value) in Modulus::ALL.into_iter().zip(moduli) {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Note::unstable(modulus.name(), value).into());
            }
        }
        Ok(Moduli::of_values(moduli.map(Some)))
    }

    fn solve(&self, observation: &Observation, calibration: &Calibration) -> Result<PointEstimate, EmtError> {
        let network = network(calibration)?;
        let state =
            State::of(&observation.conditions, (observation.grains, observation.probe), network, calibration);
        state.within_reach(calibration.name())?;
        let data = Data::of(observation, &state);
        if data.used == 0 {
            return Err(EmtError::Missing { model: NAME, missing: "at least one modulus" });
        }
        let both = (data.used > 1).then(|| scan::best(&data, network, &state, calibration.name(), false));
        let fit = match both {
            Some(Ok(fit)) if fit.eps_stddev() < UNDETERMINED => fit,
            Some(Err(error)) if data.used > 2 => return Err(error),
            // Only the coordination number, with ε distributed as in the packings of the calibration.
            _ => scan::best(&data, network, &state, calibration.name(), true)?,
        };
        if let Some(far) = fit.outside(network).iter().find(|o| o.is_too_far()) {
            return Err(too_far(far, calibration.name()));
        }
        Ok(point_estimate(&fit, &data, network, &state, &self.domain(calibration)))
    }

    fn quantities(&self, _: &Calibration) -> Vec<InferredQuantity> {
        use InferredQuantity::{Eps, EpsStiffness, K, Z};
        vec![K, Z, Eps, EpsStiffness]
    }

    fn prior_domain(&self, calibration: &Calibration) -> Domain {
        let mut domain = self.domain(calibration);
        let Some(network) = calibration.network() else { return domain };
        domain.structure[InferredQuantity::Z as usize] = Some(network.domain());
        domain.structure[InferredQuantity::Eps as usize] = Some(network.reach.eps_with_estimates());
        domain
    }

    fn likelihood<'a>(
        &'a self,
        observation: &Observation,
        calibration: &'a Calibration,
    ) -> Result<Box<dyn Likelihood + 'a>, EmtError> {
        let observation = observation.checked()?;
        self.domain(calibration).validate_contact(&observation.conditions)?;
        Ok(Box::new(NetworkLikelihood::new(NAME, &observation, network(calibration)?, calibration)?))
    }
}

pub(super) fn network(calibration: &Calibration) -> Result<&RelaxationCalibration, EmtError> {
    let missing = || EmtError::NotCalibrated { model: NAME, calibration: calibration.name().to_owned() };
    calibration.network().ok_or_else(missing)
}

fn point_estimate(
    fit: &Fit,
    data: &Data,
    network: &RelaxationCalibration,
    state: &State,
    domain: &Domain,
) -> PointEstimate {
    let point = fit.inferred(data, network, state);
    let mut notes = Vec::new();
    if !state.stress_known {
        notes.push(Note::stress_ratio_unknown());
    }
    if !state.sizes_known {
        notes.push(Note::sizes_unknown());
    }
    let outside = state.outside.iter().filter(|o| o.is_extrapolation());
    notes.extend(outside.map(Outside::note));
    notes.extend(outside_fitted(&domain.fitted, &point.structure));
    let misfit = fit
        .degrees_of_freedom(data)
        .map(|degrees_of_freedom| Misfit { chi_square: fit.chi_square, degrees_of_freedom });
    if let Some(Misfit { chi_square, degrees_of_freedom }) = misfit {
        let worst = fit.worst(data);
        let below = fit.freedom_of_variances(network);
        let of_all = normal::score(chi_square / degrees_of_freedom as f64, degrees_of_freedom, Some(below));
        // The largest of several differences.
        let of_worst = 2.0 * normal::below(-worst.1) * data.used as f64;
        let probability = normal::below(-of_all).min(of_worst);
        if probability < FALSE_ALARM {
            notes.push(Note::conflict(worst.0.name(), chi_square, degrees_of_freedom as f64, worst.1));
        } else if probability < UNLIKE {
            notes.push(Note::unlike(probability));
        }
    }
    PointEstimate { misfit, notes, ..point }
}
