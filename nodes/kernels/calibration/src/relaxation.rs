//! The laws of relaxed networks, and the scatter of packings about them.

use crate::regression::{determined, minimum};
use crate::requirements::packings;
use crate::sample::{CalibrationSample, bounds};
use crate::student::student;
use grainlab_emt::{
    CalibrationError, DeviatorLaw, GROUPS, ISOSTATIC, Invariants, NetworkState, RattlerLaw, Reach,
    RelaxationCalibration, SCATTERED, ScalingLaw, Scatter, ScatterLevels,
};
use nalgebra::{DMatrix, DVector};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Number of recipes needed: the laws are tested on each with those learned from the others.
const RECIPES: usize = 3;

/// Highest onset of stiffness, just above the isostatic point.
const HIGHEST_ONSET: f64 = ISOSTATIC + 0.05;

/// Repetitions of the fits of laws and scatter, each with the other fixed, and within these of scatter and its growth.
const REPETITIONS: usize = 2;
const REPETITIONS_OF_GROWTH: usize = 3;

/// Ranges of the growth of the variance with the variance of the radii and with ln p.
const BY_SIZES: [f64; 2] = [0.0, 500.0];
const BY_PRESSURE: [f64; 2] = [-0.5, 0.5];

/// Upper limit of |q/p| for a packing that teaches the scatter: the effect of a deviator scatters, too.
const ISOTROPIC: f64 = 0.05;

/// |q/p| below which a stress counts as isotropic: a servo that has settled leaves up to 5e-6 (`tests/golden/ensembles`).
const SETTLED: f64 = 1e-5;

/// Eigenvalue of a covariance, over its largest, to which smaller and negative ones are raised: the difference of two noisy levels
/// need not be a covariance.
const LEAST_EIGENVALUE: f64 = 1e-6;

/// One packing in the units of the laws.
struct Reduced<'a> {
    sample: &'a CalibrationSample,
    invariants: Invariants,
    state: NetworkState,
    /// Root of the weight of a state, which makes all recipes count alike.
    of_recipe: f64,
}

impl Reduced<'_> {
    /// Returns the weight of each residual in the fits: the weight of the recipe over the standard deviation of the residual.
    fn weights(&self, known: &Known) -> [f64; SCATTERED] {
        let growth = RelaxationCalibration::growth(&known.by_state, &self.state);
        let of_size = RelaxationCalibration::sample_variances(known.grains, Some(self.sample.grains));
        let [of_recipe, of_sample] = ScatterLevels::weights(self.sample.z);
        let [recipe, sample] = &known.levels;
        std::array::from_fn(|i| {
            let variance =
                recipe[(i, i)] / of_recipe[i].powi(2) + sample[(i, i)] * of_size[i] / of_sample[i].powi(2);
            self.of_recipe / (variance * growth[i]).sqrt()
        })
    }
}

struct Known {
    levels: [Scatter; 2],
    by_state: ByState,
    grains: u32,
}

/// Growth of the variances of each group with the state.
type ByState = [[f64; 2]; GROUPS.len()];

/// Learns the laws from these packings, and the scatter about laws that were learned without the file of each packing.
pub fn network(samples: &[&CalibrationSample]) -> Result<RelaxationCalibration, CalibrationError> {
    let recipes: BTreeSet<&str> = samples.iter().map(|s| s.preparation.as_str()).collect();
    if recipes.len() < RECIPES {
        let what = "different recipes";
        return Err(CalibrationError::Packings { what, found: recipes.len(), needed: RECIPES });
    }
    let mut rows: Vec<Reduced<'_>> = samples.iter().filter_map(|sample| reduced(sample)).collect();
    let mut states: BTreeMap<&str, f64> = BTreeMap::new();
    rows.iter().for_each(|r| *states.entry(r.sample.preparation.as_str()).or_default() += 1.0);
    let mean = rows.len() as f64 / states.len() as f64;
    rows.iter_mut().for_each(|r| r.of_recipe = (mean / states[r.sample.preparation.as_str()]).sqrt());
    let lowest = rows.iter().map(|r| r.sample.z).fold(f64::INFINITY, f64::min);
    if lowest <= ISOSTATIC {
        let requirement = "it must be above the isostatic 4, where a network becomes stiff";
        return Err(CalibrationError::Constant { field: "z of a packing", value: lowest, requirement });
    }
    let mut sizes: Vec<u32> = rows.iter().map(|r| r.sample.grains).collect();
    sizes.sort_unstable();
    let grains = sizes[sizes.len() / 2];
    // The first fit attributes all scatter to samples.
    let mut known =
        Known { levels: [Scatter::zeros(), Scatter::identity()], by_state: ByState::default(), grains };
    let families = families(&rows);
    for _ in 0..REPETITIONS {
        let mut residuals = Vec::with_capacity(recipes.len());
        for (recipe, family) in &families {
            // Recipes of a family are pressed alike, so the whole family is left out. A single family is left out recipe by recipe.
            let is_kept = |other: &str| {
                if families.values().any(|f| f != family) {
                    families[other] != *family
                } else {
                    other != *recipe
                }
            };
            let kept: Vec<_> = rows.iter().filter(|row| is_kept(&row.sample.preparation)).collect();
            let others = fitted(&kept, &known)?;
            // What a deviator does to the stiffness differs by itself, see `RESPONSE_STDDEV`.
            let left_out = rows
                .iter()
                .filter(|row| row.sample.preparation == *recipe && row.state.stress_ratio.abs() < ISOTROPIC);
            let of_recipe: Vec<_> = left_out.map(|row| (row, residual(&others, row))).collect();
            residuals.extend((!of_recipe.is_empty()).then_some(of_recipe));
        }
        known = levels(&residuals, known.by_state, grains)?;
    }
    let laws = fitted(&rows.iter().collect::<Vec<_>>(), &known)?;
    let [recipe, sample] = known.levels.map(|l| std::array::from_fn(|i| std::array::from_fn(|j| l[(i, j)])));
    let mut scatter = ScatterLevels { recipe, sample };
    // The recipes are a sample of all recipes: 95 % of a Student distribution, not of a normal one.
    let of_few = student(recipes.len() - 1).powi(2);
    scatter.recipe.iter_mut().flatten().for_each(|c| *c *= of_few);
    let mean = rows.iter().map(|r| r.sample.eps).sum::<f64>() / rows.len() as f64;
    let variance = rows.iter().map(|r| (r.sample.eps - mean).powi(2)).sum::<f64>() / rows.len() as f64;
    let range = |value: fn(&CalibrationSample) -> f64| {
        let (low, high) = bounds(rows.iter().map(|r| value(r.sample)));
        [low, high]
    };
    Ok(RelaxationCalibration {
        grains,
        recipes: recipes.len() as u32,
        eps_spread: [mean, variance.sqrt()],
        scatter,
        scatter_by_state: known.by_state,
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
    Some(Reduced { sample, invariants, state, of_recipe: 1.0 })
}

/// The laws alone; all other constants are zero. Where no stress ratio exceeds what a settled servo leaves, the laws are
/// without it.
fn fitted(rows: &[&Reduced<'_>], known: &Known) -> Result<RelaxationCalibration, CalibrationError> {
    const WHAT: &str = "packings";
    let packings = packings(rows.iter().map(|r| r.sample));
    let isotropic = rows.iter().all(|r| r.state.stress_ratio.abs() < SETTLED);
    let lowest = rows.iter().map(|r| r.sample.z).fold(f64::INFINITY, f64::min);
    let law = |place: usize, value: fn(&Invariants) -> f64| {
        let at = |onset: f64| {
            let point = |r: &&Reduced<'_>| {
                (
                    ScalingLaw::terms(r.sample.z, onset, &r.state),
                    value(&r.invariants),
                    r.weights(known)[place],
                )
            };
            determined(&rows.iter().map(point).collect::<Vec<_>>(), packings, WHAT)
        };
        let highest = HIGHEST_ONSET.min(lowest - 0.05);
        let onset = minimum(2.0, highest, |onset| at(onset).map_or(f64::INFINITY, |fit| fit.squares));
        Ok(ScalingLaw { coefficients: at(onset)?.coefficients, onset })
    };
    let deviator = |place: usize, value: fn(&Reduced<'_>) -> f64| {
        let point = |r: &&Reduced<'_>| {
            let stress_ratio = if isotropic { 0.0 } else { r.state.stress_ratio };
            let state = NetworkState { stress_ratio, ..r.state };
            (DeviatorLaw::terms(r.sample.z, r.sample.eps, &state), value(r), r.weights(known)[place])
        };
        let points: Vec<_> = rows.iter().map(point).collect();
        Ok(DeviatorLaw::new(determined(&points, packings, WHAT)?.coefficients))
    };
    let rattlers: Vec<_> = rows
        .iter()
        .map(|r| (RattlerLaw::terms(r.sample.z, &r.state), r.sample.k, r.weights(known)[SCATTERED - 1]))
        .collect();
    Ok(RelaxationCalibration {
        theta: law(0, |i| i.ln_theta)?,
        shear: law(1, |i| i.ln_shear)?,
        dilatation: deviator(2, |r| r.invariants.dilatation)?,
        voigt: deviator(3, |r| r.invariants.voigt)?,
        harmonic: deviator(4, |r| r.invariants.harmonic)?,
        eps_stiffness: deviator(5, |r| r.sample.eps_stiffness)?,
        rattlers: RattlerLaw(determined(&rattlers, packings, WHAT)?.coefficients),
        scatter: ScatterLevels::default(),
        scatter_by_state: [[0.0; 2]; GROUPS.len()],
        eps_spread: [0.0; 2],
        reach: Reach::default(),
        grains: 0,
        recipes: 0,
    })
}

fn residual(network: &RelaxationCalibration, row: &Reduced<'_>) -> [f64; SCATTERED] {
    let CalibrationSample { k, z, eps, eps_stiffness, .. } = *row.sample;
    let (i, state) = (&row.invariants, &row.state);
    [
        i.ln_theta - network.theta.value(z, state),
        i.ln_shear - network.shear.value(z, state),
        i.dilatation - network.dilatation.value(z, eps, state),
        i.voigt - network.voigt.value(z, eps, state),
        i.harmonic - network.harmonic.value(z, eps, state),
        eps_stiffness - network.eps_stiffness.value(z, eps, state),
        k - network.rattlers.value(z, state),
    ]
}

/// Residuals of the packings of each recipe.
type Residuals<'a> = [Vec<(&'a Reduced<'a>, [f64; SCATTERED])>];

/// Returns the family of each recipe. Recipes of one file are pressed alike, and so are recipes of two files that share a recipe.
fn families<'a>(rows: &[Reduced<'a>]) -> BTreeMap<&'a str, usize> {
    let mut of_file: BTreeMap<&str, usize> = BTreeMap::new();
    let mut of_recipe: BTreeMap<&str, usize> = BTreeMap::new();
    for row in rows {
        let next = of_file.len();
        let family = *of_file.entry(row.sample.file.as_str()).or_insert(next);
        let known = *of_recipe.entry(row.sample.preparation.as_str()).or_insert(family);
        // A recipe in two files joins their families.
        of_file.values_mut().chain(of_recipe.values_mut()).filter(|f| **f == family).for_each(|f| *f = known);
    }
    of_recipe
}

type Vector = nalgebra::SVector<f64, SCATTERED>;

/// The covariances of the residuals in two levels, and how the variances of each group grow with the state.
fn levels(residuals: &Residuals<'_>, before: ByState, grains: u32) -> Result<Known, CalibrationError> {
    let mut by_state = before;
    let mut found = [Scatter::zeros(); 2];
    for _ in 0..REPETITIONS_OF_GROWTH {
        found = two_levels(residuals, &by_state, grains);
        for (group, growth) in GROUPS.into_iter().zip(&mut by_state) {
            *growth = grown(residuals, &found, group, *growth, grains)?;
        }
    }
    Ok(Known { levels: found, by_state, grains })
}

/// The covariances between recipes, and between samples of one recipe, of so many grains: moments in which each recipe counts alike.
///
/// Of recipes with one packing each, each level has half of the variance.
fn two_levels(residuals: &Residuals<'_>, by_state: &ByState, grains: u32) -> [Scatter; 2] {
    let (mut between, mut within, mut of_means) = (Scatter::zeros(), Scatter::zeros(), Scatter::zeros());
    let mut repeated = 0.0;
    for recipe in residuals {
        let mut packings: BTreeMap<&str, Vec<Vector>> = BTreeMap::new();
        // The mean over the packings in the units of recipes, and in those of samples over them.
        let mut by_recipe: BTreeMap<&str, Vec<Vector>> = BTreeMap::new();
        let mut over = Vector::zeros();
        for (row, residual) in recipe {
            let growth = RelaxationCalibration::growth(by_state, &row.state);
            let [of_recipe, of_sample] = ScatterLevels::weights(row.sample.z);
            let reduced =
                |w: &[f64; SCATTERED]| Vector::from_fn(|i, _| residual[i] * w[i] / growth[i].sqrt());
            packings.entry(row.sample.packing.as_str()).or_default().push(reduced(&of_sample));
            by_recipe.entry(row.sample.packing.as_str()).or_default().push(reduced(&of_recipe));
            over += Vector::from_fn(|i, _| of_recipe[i] / of_sample[i]) / recipe.len() as f64;
        }
        // Sizes of the samples enter by the root of the variance at each size.
        let scale = |packing: &str| {
            let row = recipe.iter().find(|(row, _)| row.sample.packing == packing);
            let of_size =
                RelaxationCalibration::sample_variances(grains, row.map(|(row, _)| row.sample.grains));
            Vector::from(of_size.map(f64::sqrt))
        };
        let mean = |all: &[Vector]| all.iter().sum::<Vector>() / all.len() as f64;
        let means: Vec<(Vector, Vector, &Vec<Vector>)> =
            packings.iter().map(|(name, states)| (mean(states), scale(name), states)).collect();
        let weight = |scale: &Vector| 1.0 / scale[0].powi(2);
        let total: f64 = means.iter().map(|(_, scale, _)| weight(scale)).sum();
        let weights = means.iter().map(|(_, scale, _)| weight(scale) / total);
        let middle = means.iter().zip(weights.clone()).map(|((m, ..), w)| m * w).sum::<Vector>();
        let of_recipe = by_recipe.values().zip(weights.clone()).map(|(all, w)| mean(all) * w).sum::<Vector>();
        between += of_recipe * of_recipe.transpose();
        let (mut of_packings, mut of_states) = (Scatter::zeros(), Scatter::zeros());
        let (mut freedom, mut states_of_one) = (0.0, 0.0);
        for (m, scale, states) in &means {
            let off = (m - middle).component_div(scale);
            of_packings += off * off.transpose();
            for state in *states {
                let off = (state - m).component_div(scale);
                of_states += off * off.transpose();
            }
            freedom += states.len() as f64 - 1.0;
            states_of_one += states.len() as f64 / means.len() as f64;
        }
        if means.len() < 2 || freedom < means.len() as f64 {
            continue;
        }
        of_packings /= means.len() as f64 - 1.0;
        repeated += 1.0;
        within += of_packings;
        if freedom > 0.0 {
            within += of_states * ((1.0 - 1.0 / states_of_one) / freedom);
        }
        let of_mean: f64 = weights.map(|w| w * w).sum();
        let scale = means.iter().map(|(_, scale, _)| scale).sum::<Vector>() / means.len() as f64;
        let scale = scale.component_mul(&over);
        of_means += Scatter::from_fn(|i, j| of_packings[(i, j)] * scale[i] * scale[j]) * of_mean;
    }
    between /= residuals.len() as f64;
    if repeated == 0.0 {
        return [0.5, 0.5].map(|share| positive(&(between * share), &between));
    }
    within /= repeated;
    let recipes = positive(&(between - of_means / repeated), &between);
    let within = positive(&within, &within);
    [positive(&with_k(&recipes, &within), &recipes), within]
}

/// The covariance between recipes with the correlations of k of packings of one recipe: a few tens of recipes do not determine them.
fn with_k(recipes: &Scatter, within: &Scatter) -> Scatter {
    const K: usize = SCATTERED - 1;
    let stddev = |level: &Scatter, i: usize| level[(i, i)].sqrt();
    let mut found = *recipes;
    for i in 0..K {
        let correlation = within[(i, K)] / (stddev(within, i) * stddev(within, K));
        (found[(i, K)], found[(K, i)]) = (
            correlation * stddev(recipes, i) * stddev(recipes, K),
            correlation * stddev(recipes, i) * stddev(recipes, K),
        );
    }
    found
}

/// The growth of the variances of a group with the variance of the radii and with ln p that makes the residuals most probable.
fn grown(
    residuals: &Residuals<'_>,
    levels: &[Scatter; 2],
    group: Range<usize>,
    before: [f64; 2],
    grains: u32,
) -> Result<[f64; 2], CalibrationError> {
    let (start, size) = (group.start, group.len());
    let mut rows = Vec::new();
    for (row, residual) in residuals.iter().flatten() {
        let of_size = RelaxationCalibration::sample_variances(grains, Some(row.sample.grains));
        let [of_recipe, of_sample] = ScatterLevels::weights(row.sample.z);
        let covariance = DMatrix::from_fn(size, size, |i, j| {
            let (i, j) = (start + i, start + j);
            levels[0][(i, j)] / (of_recipe[i] * of_recipe[j])
                + levels[1][(i, j)] * (of_size[i] * of_size[j]).sqrt() / (of_sample[i] * of_sample[j])
        });
        let r = DVector::from_row_slice(&residual[group.clone()]);
        let too_few =
            CalibrationError::Packings { what: "packings", found: rows.len(), needed: 2 * SCATTERED };
        let square = r.dot(&(covariance.try_inverse().ok_or(too_few)? * &r));
        rows.push((row.state.size_variance, row.state.ln_pressure, square, row.of_recipe.powi(2)));
    }
    let total: f64 = rows.iter().map(|(.., weight)| weight).sum();
    // Twice the negative logarithm of the likelihood per datum, at the best factor of all variances.
    let misfit = |by_sizes: f64, by_pressure: f64| {
        let (mut ln, mut squares) = (0.0, 0.0);
        for (s2, ln_p, square, weight) in &rows {
            let variance = RelaxationCalibration::growth_of([by_sizes, by_pressure], *s2, *ln_p);
            ln += weight * variance.ln();
            squares += weight * square / variance;
        }
        ln / total + (squares / total).max(f64::MIN_POSITIVE).ln()
    };
    let [mut by_sizes, mut by_pressure] = before;
    for _ in 0..REPETITIONS_OF_GROWTH {
        by_sizes = minimum(BY_SIZES[0], BY_SIZES[1], |b| misfit(b, by_pressure));
        by_pressure = minimum(BY_PRESSURE[0], BY_PRESSURE[1], |b| misfit(by_sizes, b));
    }
    // Packings of one size, or at one pressure, do not determine a growth.
    let differ = |of: fn(&(f64, f64, f64, f64)) -> f64| {
        let (low, high) = bounds(rows.iter().map(of));
        if high > low { 1.0 } else { 0.0 }
    };
    Ok([by_sizes * differ(|r| r.0), by_pressure * differ(|r| r.1)])
}

/// Returns the nearest covariance, in units of the variances of another: negative eigenvalues are raised.
fn positive(level: &Scatter, of: &Scatter) -> Scatter {
    let scale = of.diagonal().map(|v| v.max(f64::MIN_POSITIVE).sqrt());
    let unit = Scatter::from_fn(|i, j| level[(i, j)] / (scale[i] * scale[j]));
    let mut eigen = unit.symmetric_eigen();
    let least = LEAST_EIGENVALUE * eigen.eigenvalues.amax();
    eigen.eigenvalues.iter_mut().for_each(|v| *v = v.max(least));
    let found = eigen.recompose();
    Scatter::from_fn(|i, j| 0.5 * (found[(i, j)] + found[(j, i)]) * (scale[i] * scale[j]))
}
