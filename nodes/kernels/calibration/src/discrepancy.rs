//! The errors of the models on the packings.

use crate::sample::CalibrationSample;
use crate::student::student;
use grainlab_emt::{Calibration, EmtError, Model, ModelDiscrepancy, StrainRatio, StrainRatioSource, models};
use std::collections::BTreeMap;

/// Share of the packings of recipes left out that may be more than [`FAR`] standard deviations off.
const BEYOND: f64 = 3e-3;

/// Number of standard deviations that nearly no error may exceed: errors of a model are not normal.
const FAR: f64 = 3.0;

/// The errors of every model without its own error estimate, for each γ/Δ. Every recipe counts alike.
/// The errors of each recipe are judged by those of the others, and all are enlarged until nearly none is three standard deviations off.
pub fn discrepancies(samples: &[&CalibrationSample], calibration: &Calibration) -> Vec<ModelDiscrepancy> {
    const SOURCES: [StrainRatioSource; 4] = [
        StrainRatioSource::Zero,
        StrainRatioSource::Total,
        StrainRatioSource::Elastic,
        StrainRatioSource::Contact,
    ];
    let mut learned = Vec::new();
    for model in models() {
        let sources = if model.uses_gamma() { &SOURCES[..] } else { &SOURCES[..1] };
        for source in sources {
            let Some(errors) = errors(*model, samples, *source, calibration) else { continue };
            let by_eps = by_eps(&errors);
            let all = mean_square(&errors, None);
            // The recipes are a sample of all recipes.
            let of_recipes = student(errors.len() - 1);
            let enlarged = enlarged(&errors, by_eps).map(|factor| factor * of_recipes);
            learned.push(ModelDiscrepancy {
                model: model.name().to_owned(),
                gamma: model.uses_gamma().then_some(*source),
                mean_square: std::array::from_fn(|i| {
                    std::array::from_fn(|j| all[i][j] * (enlarged[i] * enlarged[j]))
                }),
                bias: std::array::from_fn(|i| mean(&errors, None, |e| e[i]) * enlarged[i]),
                by_eps,
            });
        }
    }
    learned
}

/// ε inferred, and the errors of coordination number, k̂ and ε, by recipe.
type Errors<'a> = BTreeMap<&'a str, Vec<(f64, [f64; 3])>>;

/// Errors on the packings that the model solves; `None` if these are fewer than nine in ten.
fn errors<'a>(
    model: &dyn Model,
    samples: &[&'a CalibrationSample],
    gamma: StrainRatioSource,
    calibration: &Calibration,
) -> Option<Errors<'a>> {
    let error = |s: &CalibrationSample| -> Result<Option<(f64, [f64; 3])>, EmtError> {
        let point = model.solve(&s.observation(gamma).checked()?, calibration)?;
        if point.discrepancy.is_some() {
            return Ok(None);
        }
        let found = point.structure;
        let k_hat = found.k_hat.map_or(0.0, |k_hat| k_hat - s.k);
        Ok(found.k.zip(found.eps).map(|(k, eps)| (eps, [k - s.k, k_hat, eps - s.eps])))
    };
    let known =
        |s: &CalibrationSample| gamma == StrainRatioSource::Zero || StrainRatio::is_known(&s.gamma, gamma);
    let (mut errors, mut asked, mut solved) = (Errors::new(), 0, 0);
    for sample in samples.iter().filter(|s| known(s)) {
        asked += 1;
        if let Some(found) = error(sample).ok().flatten() {
            solved += 1;
            errors.entry(sample.preparation.as_str()).or_default().push(found);
        }
    }
    (solved > 0 && solved * 10 >= asked * 9).then_some(errors)
}

/// Mean of a number of each error, first over each recipe and then over the recipes but one.
fn mean(errors: &Errors<'_>, without: Option<&str>, of: impl Fn(&[f64; 3]) -> f64) -> f64 {
    let kept = errors.iter().filter(|(recipe, _)| Some(**recipe) != without).map(|(_, all)| all);
    let recipes = kept.clone().count() as f64;
    kept.map(|all| all.iter().map(|(_, e)| of(e)).sum::<f64>() / all.len() as f64).sum::<f64>() / recipes
}

fn mean_square(errors: &Errors<'_>, without: Option<&str>) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| mean(errors, without, |e| e[i] * e[j])))
}

/// Factor, 1 or more, of the standard deviation of each error.
fn enlarged(errors: &Errors<'_>, by_eps: [f64; 2]) -> [f64; 3] {
    let mut off: [Vec<f64>; 3] = Default::default();
    for (recipe, all) in errors {
        let others = if errors.len() > 1 { Some(*recipe) } else { None };
        let stated = mean_square(errors, others);
        for (eps, error) in all {
            let scale = [1.0, 1.0, by_eps[0] + by_eps[1] * eps * eps];
            for i in 0..3 {
                let variance = stated[i][i] * scale[i];
                off[i].push(if variance > 0.0 { error[i].abs() / variance.sqrt() } else { 0.0 });
            }
        }
    }
    off.map(|mut off| {
        off.sort_by(f64::total_cmp);
        let last = ((1.0 - BEYOND) * off.len() as f64) as usize;
        off.get(last).map_or(1.0, |furthest| (furthest / FAR).max(1.0))
    })
}

/// Growth of the square of the error of ε with the inferred ε: f0 + f1 ε² by least squares, with a mean of 1.
fn by_eps(errors: &Errors<'_>) -> [f64; 2] {
    let all = || errors.values().flatten();
    let count = all().count() as f64;
    let mean =
        |f: &dyn Fn(f64, f64) -> f64| all().map(|(eps, e)| f(eps * eps, e[2] * e[2])).sum::<f64>() / count;
    let (square, error) = (mean(&|x, _| x), mean(&|_, y| y));
    let variance = mean(&|x, _| (x - square).powi(2));
    let slope = mean(&|x, y| (x - square) * (y - error)) / variance / error;
    // Not below a quarter of the mean at ε = 0, and not falling.
    let slope = slope.clamp(0.0, 0.75 / square);
    if slope.is_finite() { [1.0 - slope * square, slope] } else { [1.0, 0.0] }
}
