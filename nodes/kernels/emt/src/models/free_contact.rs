//! The relaxed network with contacts that are not known: the inversion of a series ([`crate::infer_series`]) at one pressure.
//!
//! The ratio of the moduli and a prior of simulated preparations determine z; contact law, k_t/k_n and the level of the moduli
//! are unknowns. Contacts of a stated law have its k_t/k_n, and its level where the material of the grains gives it.

use super::relaxed::network;
use crate::calibration::{Calibration, NetworkState, Outside, RelaxationCalibration};
use crate::conditions::{Conditions, Measured, UNKNOWN_SIZE_SPREAD, UNKNOWN_STRESS_RATIO};
use crate::domain::Domain;
use crate::error::EmtError;
use crate::likelihood::Likelihood;
use crate::model::Model;
use crate::moduli::{Moduli, Modulus};
use crate::observation::Observation;
use crate::point_estimate::{Jacobian, PointEstimate};
use crate::probe::Probe;
use crate::series::{Interval, SeriesPrior, SeriesRow, SingleEstimate, SpeedMode, SpeedSeries};
use grainlab_core::Material;
use grainlab_core::contact::SpringLaw;
use grainlab_core::notes::Note;
use grainlab_core::results::{InferredQuantity, Microstructure, MicrostructureCovariance};
use nalgebra::DMatrix;
use std::f64::consts::FRAC_PI_2;

/// The relaxed network with unknown contacts: model `free-contact`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FreeContact;

pub(crate) const NAME: &str = "free-contact";

/// p/E* of samples, and k_t/k_n of the packings that taught.
const PRESSURES: [f64; 2] = [1e-8, 1e-2];
const RATIOS: [f64; 2] = [0.25, 1.0];

/// Relative error of moduli of which none is stated: that of the series needs one.
const EXACT: f64 = 1e-3;

/// Standard deviations of z, ε and ε weighted by stiffness that rough contacts add to the posterior: the roughness is not used, and the
/// preparations of the prior were pressed. The tests of `grainlab_calibration` fit them to `tests/golden/ensembles/rough_recipes.csv`.
pub const ROUGH_CONTACTS: [f64; 3] = [0.090, 0.022, 0.0097];

/// Number of times that the stiffness of Hertz contacts is adapted to moduli of linear springs. Each one changes ln E* by a tenth of the
/// change before, because z over pressure depends on it little.
const PASSES: usize = 3;

/// Share of the posterior beyond the highest z that is stated, or below the lowest of the calibration's packings, above which it is said.
const SAID: f64 = 0.1;

/// Modes whose ρ v² are the moduli; C13 acts through Θ.
const WAVES: [(Modulus, SpeedMode, f64); 5] = [
    (Modulus::G12, SpeedMode::Sh, FRAC_PI_2),
    (Modulus::G13, SpeedMode::Sv, 0.0),
    (Modulus::Theta, SpeedMode::Bulk, 0.0),
    (Modulus::C11, SpeedMode::P, FRAC_PI_2),
    (Modulus::C33, SpeedMode::P, 0.0),
];

impl Model for FreeContact {
    fn name(&self) -> &'static str {
        NAME
    }

    fn domain(&self, calibration: &Calibration) -> Domain {
        use InferredQuantity::{Eps, Z};
        let ranges = calibration.network().map(|n| [(Z, n.domain()), (Eps, n.reach.eps_with_estimates())]);
        let of = Domain::new(NAME, ranges.as_ref().map_or(&[], |r| r.as_slice()));
        Domain { any_contact: true, compares_state: true, ..of }
    }

    fn predict(&self, _: &Microstructure, _: &Conditions, _: &Calibration) -> Result<Moduli, EmtError> {
        Err(EmtError::Missing { model: NAME, missing: "the contact law, without which there are no moduli" })
    }

    fn solve(&self, observation: &Observation, calibration: &Calibration) -> Result<PointEstimate, EmtError> {
        let network = network(calibration)?;
        let conditions = &observation.conditions;
        let mut material = conditions.material.unwrap_or(*calibration.material());
        let free = SeriesPrior::builtin();
        let prior = match conditions.contact_law {
            None => free.clone(),
            Some(law) => free.of_springs(&law.springs, &material),
        };
        let within = |quantity, value: f64, [low, high]: [f64; 2]| {
            let calibration = calibration.name().to_owned();
            let is_inside = (low..=high).contains(&value);
            let reason = || EmtError::from(Note::too_far(quantity, calibration, value, low, high));
            is_inside.then_some(()).ok_or_else(reason)
        };
        let is_linear = conditions.contact_law.is_some_and(|law| matches!(law.springs, SpringLaw::Linear(_)));
        if is_linear {
            material = as_stiff_as_hertz(observation, material, network, &prior)?;
        }
        let reduced = observation.pressure() / material.effective_young();
        within(
            if is_linear { "p/E* (E* of Hertz contacts as stiff as these)" } else { "p/E*" },
            reduced,
            PRESSURES,
        )?;
        prior.known_ratio().map_or(Ok(()), |ratio| within("k_t/k_n", ratio, RATIOS))?;
        let sizes = conditions.size_spread.unwrap_or(UNKNOWN_SIZE_SPREAD.value);
        let stress = conditions.stress_ratio.unwrap_or(UNKNOWN_STRESS_RATIO).value;
        let state = NetworkState::of(observation.pressure(), &material, sizes, stress);
        let mut outside = network.reach.outside(reduced, &state);
        // k_t/k_n has the range of the series.
        outside.retain(|o| o.is_extrapolation() && o.quantity != "k_t/k_n");
        if let Some(far) = outside.iter().find(|o| o.is_too_far()) {
            return Err(super::relaxed::too_far(far, calibration.name()));
        }
        let found = SingleEstimate::of(&series(observation, material)?, network, &prior)?;
        Ok(point_estimate(&found, (conditions, observation.probe), &outside, network.reach.z[0]))
    }

    fn likelihood<'a>(
        &'a self,
        _: &Observation,
        _: &'a Calibration,
    ) -> Result<Box<dyn Likelihood + 'a>, EmtError> {
        Err(EmtError::NoLikelihood { model: NAME, reason: "its posterior is stated, with its own prior" })
    }
}

/// Returns the material of grains whose Hertz contacts give these moduli. Linear springs have a stiffness of their own, which does
/// not follow from the material of the grains; Hertz contacts as stiff have the same pressure over stiffness.
fn as_stiff_as_hertz(
    observation: &Observation,
    material: Material,
    network: &RelaxationCalibration,
    prior: &SeriesPrior,
) -> Result<Material, EmtError> {
    let mut material = material;
    for _ in 0..PASSES {
        let level = SingleEstimate::of(&series(observation, material)?, network, prior)?.level.mean;
        // Moduli of Hertz contacts grow as E*^(2/3) at one pressure.
        material.shear_modulus *= (1.5 * level).exp();
    }
    Ok(material)
}

fn series(observation: &Observation, material: Material) -> Result<SpeedSeries, EmtError> {
    let conditions = &observation.conditions;
    let known =
        |(modulus, ..): &(Modulus, SpeedMode, f64)| Some((*modulus, observation.moduli.get(*modulus)?));
    let moduli: Vec<(Modulus, f64)> = WAVES.iter().filter_map(known).collect();
    if moduli.len() < 2 {
        return Err(EmtError::Missing {
            model: NAME,
            missing: "a second one of G12, G13, Theta, C11 and C33",
        });
    }
    let pressure = conditions.pressure.value;
    let row = |(_, mode, angle): &(Modulus, SpeedMode, f64), value: f64| SeriesRow {
        pressure,
        density: 1.0,
        mode: *mode,
        angle: Some(*angle),
        speed: Some(value.sqrt()),
        stddev: EXACT,
        common_stddev: 0.0,
    };
    let rows = WAVES.iter().filter_map(|wave| Some(row(wave, observation.moduli.get(wave.0)?))).collect();
    // ln v is half of ln of the modulus. Moduli that follow from others have no error of their own.
    let covariance = DMatrix::from_fn(moduli.len(), moduli.len(), |j, k| {
        let ((a, at), (b, by)) = (moduli[j], moduli[k]);
        let stated = observation.covariance.map_or(0.0, |c| c[(a as usize, b as usize)]);
        0.25 * stated / (at * by) + if j == k { EXACT * EXACT } else { 0.0 }
    });
    let sizes = conditions.size_spread.map_or(UNKNOWN_SIZE_SPREAD, Measured::exact);
    let stress = conditions.stress_ratio.unwrap_or(UNKNOWN_STRESS_RATIO);
    let of_poisson = conditions.poisson_ratio_stddev / (1.0 - material.poisson_ratio);
    Ok(SpeedSeries {
        shear_modulus_stddev: (conditions.shear_modulus_stddev / material.shear_modulus).hypot(of_poisson),
        pressure_stddev: conditions.pressure.stddev / pressure,
        size_variance: [sizes.value.powi(2), sizes.variance_stddev()],
        stress_ratio: [stress.value, stress.stddev],
        grains: observation.grains,
        covariance: Some(covariance),
        ..SpeedSeries::of(rows, material)
    })
}

fn point_estimate(
    found: &SingleEstimate,
    (conditions, probe): (&Conditions, Probe),
    outside: &[Outside],
    lowest: f64,
) -> PointEstimate {
    use InferredQuantity::{Eps, EpsStiffness, Z};
    let named = [Z, Eps, EpsStiffness];
    let used = if found.has_eps { named.len() } else { 1 };
    let mut structure = Microstructure::default();
    let mut covariance = MicrostructureCovariance::zeros();
    let mut bounds = [None; InferredQuantity::COUNT];
    let of_probe = probe.errors().map_or([0.0; 3], |errors| [errors.z, errors.eps, errors.eps]);
    let is_rough = conditions.contact_law.is_some_and(|law| law.springs.name() == "rough");
    for (i, a) in named[..used].iter().enumerate() {
        let of = &found.marginals[i];
        let of_rough = if is_rough { ROUGH_CONTACTS[i] } else { 0.0 };
        let beyond = of_rough.hypot(of_probe[i]);
        let wider = of.stddev.hypot(beyond) / of.stddev;
        structure = structure.with(*a, of.mean);
        bounds[*a as usize] = Some([of.low, of.high].map(|end| of.mean + wider * (end - of.mean)));
        for (j, b) in named[..used].iter().enumerate() {
            covariance[(*a as usize, *b as usize)] = found.covariance[(i, j)];
        }
        covariance[(*a as usize, *a as usize)] += beyond * beyond;
    }
    let mut notes = Vec::new();
    let level = &found.level;
    if level.is_far() {
        notes.push(Note::far_level(level.mean.exp()));
    }
    if found.p < crate::SeriesEstimate::CONTRADICTORY {
        notes.push(Note::improbable(found.p));
    }
    let Interval { mean, stddev, .. } = found.stiffness_ratio;
    notes.push(match conditions.contact_law {
        None => Note::contacts_inferred(mean, stddev, level.mean.exp()),
        Some(law) => Note::contacts_stated(law.springs.name()),
    });
    let z = &found.marginals[0];
    if z.is_undetermined() {
        notes.push(Note::hardly_determined(Z.name(), z.left()));
    }
    if found.z_beyond > SAID {
        notes.push(Note::higher_z(found.z_beyond));
    }
    if found.z_below > SAID {
        notes.push(Note::lower_z(found.z_below, lowest));
    }
    if conditions.stress_ratio.is_none() {
        notes.push(Note::stress_ratio_unknown());
    }
    if conditions.size_spread.is_none() {
        notes.push(Note::sizes_unknown());
    }
    notes.extend(outside.iter().map(Outside::note));
    PointEstimate {
        jacobian: Some(Jacobian::zeros()),
        discrepancy: Some(covariance),
        bounds: Some(bounds),
        notes,
        ..PointEstimate::exact(structure)
    }
}
