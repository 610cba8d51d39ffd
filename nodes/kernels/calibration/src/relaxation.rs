//! The laws of relaxed networks, and the scatter of packings about them.

use crate::regression::{determined, minimum};
use crate::requirements::packings;
use crate::sample::{CalibrationSample, bounds};
use crate::student::student;
use grainlab_emt::{
    CalibrationError, DeviatorLaw, GROUPS, ISOSTATIC, Invariants, NetworkState, RattlerLaw, Reach,
    RelaxationCalibration, SCATTERED, ScalingLaw, Scatter,
};
use std::collections::BTreeSet;

/// Number of recipes needed: the laws are tested on each with those learned from the others.
const RECIPES: usize = 3;

/// Highest onset of stiffness, just above the isostatic point.
const HIGHEST_ONSET: f64 = ISOSTATIC + 0.05;

/// Repetitions of the fit of the scatter and of its growth, each with the other fixed; the third changes nothing.
const REPETITIONS: usize = 4;

/// |q/p| below which a stress counts as isotropic: a servo that has settled leaves up to 5e-6 (`tests/golden/ensembles`).
const SETTLED: f64 = 1e-5;

/// One packing in the units of the laws, with its weight in the fits.
struct Reduced<'a> {
    sample: &'a CalibrationSample,
    invariants: Invariants,
    state: NetworkState,
    weight: f64,
}

/// The laws from these packings, and their scatter from laws learned without the recipe of each packing.
pub(crate) fn network(samples: &[&CalibrationSample]) -> Result<RelaxationCalibration, CalibrationError> {
    let recipes: BTreeSet<&str> = samples.iter().map(|s| s.preparation.as_str()).collect();
    if recipes.len() < RECIPES {
        let what = "different recipes";
        return Err(CalibrationError::Packings { what, found: recipes.len(), needed: RECIPES });
    }
    let rows: Vec<Reduced<'_>> = samples.iter().filter_map(|sample| reduced(sample)).collect();
    let lowest = rows.iter().map(|r| r.sample.z).fold(f64::INFINITY, f64::min);
    if lowest <= ISOSTATIC {
        let requirement = "it must be above the isostatic 4, where a network becomes stiff";
        return Err(CalibrationError::Constant { field: "z of a packing", value: lowest, requirement });
    }
    let laws = fitted(&rows.iter().collect::<Vec<_>>())?;
    let mut residuals = Vec::with_capacity(rows.len());
    for recipe in &recipes {
        let (left_out, kept): (Vec<_>, Vec<_>) =
            rows.iter().partition(|row| row.sample.preparation == *recipe);
        let others = fitted(&kept)?;
        residuals.extend(left_out.into_iter().map(|row| (row, residual(&others, row))));
    }
    let (scatter, scatter_by_state) = scatter(&residuals)?;
    // The recipes are a sample of all recipes: 95 % of a Student distribution, not of a normal one.
    let scatter = scatter * student(recipes.len() - 1).powi(2);
    let mean = rows.iter().map(|r| r.sample.eps).sum::<f64>() / rows.len() as f64;
    let variance = rows.iter().map(|r| (r.sample.eps - mean).powi(2)).sum::<f64>() / rows.len() as f64;
    let range = |value: fn(&CalibrationSample) -> f64| {
        let (low, high) = bounds(rows.iter().map(|r| value(r.sample)));
        [low, high]
    };
    Ok(RelaxationCalibration {
        grains: rows.iter().map(|r| r.sample.grains).min().unwrap_or(0),
        recipes: recipes.len() as u32,
        eps_spread: [mean, variance.sqrt()],
        scatter: std::array::from_fn(|i| std::array::from_fn(|j| scatter[(i, j)])),
        scatter_by_state,
        reach: Reach {
            z: range(|s| s.z),
            eps: range(|s| s.eps),
            pressure: range(CalibrationSample::reduced_pressure),
            stiffness_ratio: range(|s| s.material.stiffness_ratio()),
            size_spread: range(|s| s.size_spread),
            stress_ratio: range(|s| s.stress_ratio),
        },
        ..laws
    })
}

/// `None` without a positive bulk and shear modulus.
fn reduced(sample: &CalibrationSample) -> Option<Reduced<'_>> {
    let mut invariants = Invariants::of(&sample.moduli)?;
    let unit = sample.material.effective_young().cbrt().powi(2) * sample.pressure.cbrt();
    invariants.ln_theta -= unit.ln();
    invariants.ln_shear -= unit.ln();
    let state = NetworkState::of(sample.pressure, &sample.material, sample.size_spread, sample.stress_ratio);
    Some(Reduced { sample, invariants, state, weight: RelaxationCalibration::excess(sample.z) })
}

/// The laws alone; all other constants are zero. Where no stress ratio exceeds what a settled servo leaves, the laws are
/// without it.
fn fitted(rows: &[&Reduced<'_>]) -> Result<RelaxationCalibration, CalibrationError> {
    const WHAT: &str = "packings";
    let packings = packings(rows.iter().map(|r| r.sample));
    let isotropic = rows.iter().all(|r| r.state.stress_ratio.abs() < SETTLED);
    let lowest = rows.iter().map(|r| r.sample.z).fold(f64::INFINITY, f64::min);
    let law = |value: fn(&Invariants) -> f64| {
        let at = |onset: f64| {
            let point = |r: &&Reduced<'_>| {
                (ScalingLaw::terms(r.sample.z, onset, &r.state), value(&r.invariants), r.weight)
            };
            determined(&rows.iter().map(point).collect::<Vec<_>>(), packings, WHAT)
        };
        let highest = HIGHEST_ONSET.min(lowest - 0.05);
        let onset = minimum(2.0, highest, |onset| at(onset).map_or(f64::INFINITY, |fit| fit.squares));
        Ok(ScalingLaw { coefficients: at(onset)?.coefficients, onset })
    };
    let deviator = |value: fn(&Reduced<'_>) -> f64| {
        let point = |r: &&Reduced<'_>| {
            let stress_ratio = if isotropic { 0.0 } else { r.state.stress_ratio };
            let state = NetworkState { stress_ratio, ..r.state };
            (DeviatorLaw::terms(r.sample.z, r.sample.eps, &state), value(r), r.weight)
        };
        let points: Vec<_> = rows.iter().map(point).collect();
        Ok(DeviatorLaw::new(determined(&points, packings, WHAT)?.coefficients))
    };
    let rattlers: Vec<_> =
        rows.iter().map(|r| (RattlerLaw::terms(r.sample.z, &r.state), r.sample.k, 1.0)).collect();
    Ok(RelaxationCalibration {
        theta: law(|i| i.ln_theta)?,
        shear: law(|i| i.ln_shear)?,
        dilatation: deviator(|r| r.invariants.dilatation)?,
        voigt: deviator(|r| r.invariants.voigt)?,
        harmonic: deviator(|r| r.invariants.harmonic)?,
        eps_stiffness: deviator(|r| r.sample.eps_stiffness)?,
        rattlers: RattlerLaw(determined(&rattlers, packings, WHAT)?.coefficients),
        scatter: [[0.0; SCATTERED]; SCATTERED],
        scatter_by_state: [[0.0; 2]; GROUPS.len()],
        eps_spread: [0.0; 2],
        reach: Reach::default(),
        grains: 0,
        recipes: 0,
    })
}

/// The difference between a packing and the laws, with the weights of [`RelaxationCalibration::weights`].
fn residual(network: &RelaxationCalibration, row: &Reduced<'_>) -> [f64; SCATTERED] {
    let CalibrationSample { k, z, eps, eps_stiffness, .. } = *row.sample;
    let (i, state) = (&row.invariants, &row.state);
    let off = [
        i.ln_theta - network.theta.value(z, state),
        i.ln_shear - network.shear.value(z, state),
        i.dilatation - network.dilatation.value(z, eps, state),
        i.voigt - network.voigt.value(z, eps, state),
        i.harmonic - network.harmonic.value(z, eps, state),
        eps_stiffness - network.eps_stiffness.value(z, eps, state),
        k - network.rattlers.value(z, state),
    ];
    let weights = RelaxationCalibration::weights(z);
    std::array::from_fn(|i| off[i] * weights[i])
}

/// Covariance of the residuals, and how the variances of each group grow with the variance of the radii and with ln p.
fn scatter(
    residuals: &[(&Reduced<'_>, [f64; SCATTERED])],
) -> Result<(Scatter, [[f64; 2]; GROUPS.len()]), CalibrationError> {
    let mut by_state = [[0.0; 2]; GROUPS.len()];
    let packings = packings(residuals.iter().map(|(row, _)| row.sample));
    let mut covariance = Scatter::zeros();
    for _ in 0..REPETITIONS {
        covariance = Scatter::zeros();
        for (row, residual) in residuals {
            let growth = RelaxationCalibration::growth(&by_state, &row.state);
            let r = nalgebra::SVector::<f64, SCATTERED>::from_fn(|i, _| residual[i] / growth[i].sqrt());
            covariance += r * r.transpose() / residuals.len() as f64;
        }
        for (group, growth) in GROUPS.into_iter().zip(&mut by_state) {
            let (start, size) = (group.start, group.len());
            let inverse = covariance.view((start, start), (size, size)).into_owned().try_inverse();
            let too_few = CalibrationError::Packings {
                what: "packings",
                found: residuals.len(),
                needed: 2 * SCATTERED,
            };
            let inverse = inverse.ok_or(too_few)?;
            // The logarithm of the normalised square of the residual: its mean changes with the state as that of the variance.
            let points: Vec<_> = residuals
                .iter()
                .map(|(row, residual)| {
                    let r = nalgebra::DVector::from_row_slice(&residual[group.clone()]);
                    let square = r.dot(&(&inverse * &r)).max(f64::MIN_POSITIVE);
                    ([1.0, row.state.size_variance, row.state.ln_pressure], square.ln(), 1.0)
                })
                .collect();
            let [_, by_sizes, by_pressure] = determined(&points, packings, "packings")?.coefficients;
            *growth = [by_sizes, by_pressure];
        }
    }
    Ok((covariance, by_state))
}
