//! The notes that apply to the estimate of any model, and the bounds of any structure.

use crate::calibration::{Calibration, NetworkState, Outside, inverse_grains};
use crate::conditions::{Conditions, StrainRatioSource};
use crate::domain::Domain;
use crate::error::EmtError;
use crate::moduli::{MODULI, Modulus};
use crate::observation::{Observation, UNKNOWN_ERROR};
use crate::probe::{Probe, UNKNOWN_PROBE};
use grainlab_core::notes::Note;
use grainlab_core::results::{INFERENCE_INPUTS, InferredQuantity, Microstructure};

/// Coordination number of a close packing of equal spheres, the largest possible.
const CLOSE_PACKING: f64 = 12.0;

/// Asymmetry beyond which a stiffness counts as not isotropic about e3, for any number of grains.
const ASYMMETRY: f64 = 0.05;

/// Upper bound of asymmetry times the root of the number of grains, for packings that are isotropic about e3.
const SCATTER: f64 = 2.2;

/// Largest coordination number of a packing of spheres of any sizes, 8 + 4√3 = 14.93 (Kuperberg and Schramm 1994), with a margin.
const MAX_COORDINATION: f64 = 15.0;

/// Coordination number below which an estimate is none. Packings that carry a load have more than one contact per grain, but
/// an effective medium without relaxation gives 0.03 for soft ones (`series.csv`). Moduli in kPa for Pa give 0.005.
const MIN_COORDINATION: f64 = 0.01;

/// ε of any contact directions, 5/2 of the mean of P2: from all in the plane of isotropy to all along the axis.
const EPS: [f64; 2] = [-1.25, 2.5];

/// Imbalance of moduli that were rounded to three or four digits.
pub const ROUNDING: f64 = 5e-3;

/// Probability with which chance alone raises the alarm that the data contradict the model, by χ² or by the modulus furthest
/// from its prediction: with that of [`UNBALANCED`], consistent data raise less than one alarm in a hundred.
pub(crate) const FALSE_ALARM: f64 = 1e-3;

/// Number of standard deviations that chance exceeds, to either side, once in a thousand times.
pub(crate) const CERTAIN: f64 = 3.29;

/// Number of standard deviations of the relation between the six moduli that chance exceeds, to either side, five times in a
/// thousand: no other check finds a fault of one modulus by the errors of the data alone.
const UNBALANCED: f64 = 2.81;

/// Relative error of a modulus beyond which linear propagation is inaccurate: at 5 % the intervals still cover their
/// level, at 30 % they do not.
const LARGE_ERROR: f64 = 0.1;

/// Relative error of the pressure, or of E* by the properties of the grains, beyond which linear propagation is inaccurate. The
/// moduli grow with roots of them.
const LARGE_STATE_ERROR: f64 = 0.3;

/// Refuses a counted structure that no packing has.
pub fn check_structure(structure: &Microstructure) -> Result<(), EmtError> {
    for quantity in InferredQuantity::ALL {
        let Some(value) = structure.get(quantity) else { continue };
        let [low, high] = if quantity.is_coordination() { [0.0, MAX_COORDINATION] } else { EPS };
        // Also where it is not a number.
        if !(low..=high).contains(&value) {
            return Err(EmtError::NoStructure { quantity: quantity.name(), value, low, high });
        }
    }
    Ok(())
}

/// Refuses an inferred structure that is beyond every packing that carries a load.
pub(crate) fn check_inferred(structure: &Microstructure) -> Result<(), EmtError> {
    for quantity in InferredQuantity::ALL {
        let Some(value) = structure.get(quantity) else { continue };
        let [low, high] = if quantity.is_coordination() { [MIN_COORDINATION, MAX_COORDINATION] } else { EPS };
        if !(low..=high).contains(&value) {
            return Err(Note::no_packing(quantity.name(), value, low, high).into());
        }
    }
    Ok(())
}

/// Notes that follow from the structure alone; a prior may change them.
pub(crate) fn of_structure(structure: &Microstructure) -> Vec<Note> {
    let mut notes = Vec::new();
    let coordinations = [structure.k, structure.k_hat, structure.z].into_iter().flatten();
    let highest = coordinations.fold(0.0, f64::max);
    if highest > CLOSE_PACKING {
        notes.push(Note::coordination_impossible(highest));
    }
    for quantity in [InferredQuantity::K, InferredQuantity::Z] {
        if let Some(value) = structure.get(quantity).filter(|value| *value < 1.0) {
            notes.push(Note::coordination_absurd(quantity.name(), value));
        }
    }
    if let Some(eps) = structure.eps.filter(|eps| !(-0.5..=1.0).contains(eps)) {
        notes.push(Note::eps_out_of_range(eps));
    }
    notes
}

/// Notes that follow from the observation alone.
pub(crate) fn common(
    observation: &Observation,
    calibration: &Calibration,
    uses_gamma: bool,
    domain: &Domain,
) -> Vec<Note> {
    let Domain { compares_state, any_contact, .. } = *domain;
    // Formulas with the solid fraction have the material of the grains, and no constants of a calibration.
    let uses_constants = !domain.needs_solid_fraction;
    let conditions = &observation.conditions;
    let mut notes = Vec::new();
    let mut add = |applies: bool, note: Note| {
        if applies {
            notes.push(note);
        }
    };
    let outside = |v: f64, [low, high]: [f64; 2]| !(low..=high).contains(&v);
    if let Some(range) = calibration.pressures.filter(|_| !compares_state) {
        let pressure = observation.pressure();
        // The tolerance of a servo is not an extrapolation.
        let wide = [0.99 * range[0], 1.01 * range[1]];
        add(outside(pressure, wide), Note::pressure_outside_calibration(pressure, range[0], range[1]));
    }
    if let Some(nu) =
        conditions.material.map(|m| m.poisson_ratio).filter(|_| uses_constants && !compares_state)
    {
        let calibrated = calibration.material().poisson_ratio;
        add((nu - calibrated).abs() > 1e-6, Note::other_grains(nu, calibrated));
    }
    add(conditions.contact_law.is_none() && !any_contact, Note::contact_law_assumed());
    add(compares_state && observation.grains.is_none(), Note::grains_unknown());
    add(compares_state && observation.probe == Probe::Unknown, unknown_probe());
    if !compares_state {
        outside_errors(conditions, calibration).iter().for_each(|outside| add(true, outside.note()));
    }
    let rolls = conditions.contact_law.is_some_and(|law| law.rolling.is_some());
    add(rolls, Note::rolling_resistance());
    if let Some(asymmetry) = observation.asymmetry {
        let scatter = SCATTER * inverse_grains(observation.grains).sqrt();
        // Independent errors of the entries of a stiffness are asymmetric, too.
        let of_errors = CERTAIN * largest_error(observation).map_or(0.0, |(_, relative)| relative);
        let usual = scatter.max(ASYMMETRY).hypot(of_errors);
        add(asymmetry > usual, Note::not_transversely_isotropic(asymmetry));
    }
    add(observation.moduli.unstable(observation.covariance.as_ref(), CERTAIN), Note::not_one_medium());
    if let Some(relative) = observation.moduli.imbalance() {
        let errors = observation.covariance.as_ref();
        let stddev = errors.and_then(|c| observation.moduli.imbalance_stddev(c)).unwrap_or(0.0);
        add(relative.abs() > ROUNDING.max(UNBALANCED * stddev), Note::imbalance(relative));
    }
    if let Some((modulus, relative)) = largest_error(observation) {
        add(relative > LARGE_ERROR, Note::errors_large(modulus.name(), relative));
    }
    for modulus in Modulus::ALL {
        add(
            observation.taken_as_unknown[modulus as usize],
            Note::taken_as_unknown(modulus.name(), UNKNOWN_ERROR),
        );
    }
    for (input, relative) in state_errors(conditions, calibration) {
        add(relative > LARGE_STATE_ERROR, Note::state_error_large(input, relative));
    }
    if uses_gamma {
        let g = conditions.gamma.value;
        add(outside(g, [-0.3, 0.1]), Note::gamma_large(g));
        add(outside(g, [-0.5, 0.25]), Note::contacts_open(g));
        add(conditions.gamma.source == StrainRatioSource::Zero, Note::gamma_assumed_zero());
    }
    notes
}

fn unknown_probe() -> Note {
    Note::probe_unknown(UNKNOWN_PROBE.z, UNKNOWN_PROBE.k, UNKNOWN_PROBE.eps)
}

/// The relative errors of the pressure and of E*, by the inputs that cause them.
fn state_errors(conditions: &Conditions, calibration: &Calibration) -> [(&'static str, f64); 3] {
    let grains = conditions.material.as_ref().unwrap_or(calibration.material());
    let stddevs = conditions.stddevs(calibration.material());
    // E* = G/(1 − ν).
    let of_poisson = stddevs[6] / (1.0 - grains.poisson_ratio);
    let named = |at: usize| INFERENCE_INPUTS[MODULI + at];
    [(named(0), stddevs[0]), (named(5), stddevs[5]), ("factor 1 - nu of the grains", of_poisson)]
}

/// Quantities of the state outside the packings on which the errors of the models were learned.
fn outside_errors(conditions: &Conditions, calibration: &Calibration) -> Vec<Outside> {
    let learned = calibration.network().or_else(|| Calibration::builtin("grainlab")?.network());
    let Some(network) = learned else { return Vec::new() };
    let grains = conditions.material.as_ref().unwrap_or(calibration.material());
    let stress_ratio = conditions.stress_ratio.map_or(0.0, |ratio| ratio.value);
    let size_spread = conditions.size_spread.unwrap_or(0.0);
    let pressure = conditions.pressure.value;
    let state = NetworkState::of(pressure, grains, size_spread, stress_ratio);
    let mut outside = network.reach.outside(pressure / grains.effective_young(), &state);
    outside.retain(Outside::is_extrapolation);
    outside
}

fn largest_error(observation: &Observation) -> Option<(Modulus, f64)> {
    let covariance = observation.covariance.as_ref()?;
    let relative = |(modulus, value): (Modulus, f64)| {
        let i = modulus as usize;
        (modulus, covariance[(i, i)].max(0.0).sqrt() / value.abs())
    };
    // C13 is a small difference of large numbers: its relative error is not meaningful.
    let given = observation.moduli.known().filter(|(m, _)| *m != Modulus::C13).map(relative);
    given.max_by(|a, b| a.1.total_cmp(&b.1))
}
