//! The errors of the models on the packings.

use super::sample::CalibrationSample;
use crate::calibration::{Calibration, ModelDiscrepancy};
use crate::conditions::{StrainRatio, StrainRatioSource};
use crate::error::EmtError;
use crate::model::Model;
use crate::registry::models;
use grainlab_core::results::InferredQuantity;

/// The errors of every model without its own error estimate, for each γ/Δ and coordination number. Isotropic
/// packings contribute only errors of ε, because every model is fitted to their moduli.
pub(super) fn discrepancies(
    isotropic: &[CalibrationSample],
    anisotropic: &[CalibrationSample],
    calibration: &Calibration,
) -> Vec<ModelDiscrepancy> {
    const SOURCES: [StrainRatioSource; 4] = [
        StrainRatioSource::Zero,
        StrainRatioSource::Total,
        StrainRatioSource::Elastic,
        StrainRatioSource::Contact,
    ];
    let mut learned = Vec::new();
    for kind in [InferredQuantity::K, InferredQuantity::Z] {
        let Some(calibration) = calibration.with_coordination_kind(kind) else { continue };
        for model in models() {
            let sources = if model.uses_gamma() { &SOURCES[..] } else { &SOURCES[..1] };
            for source in sources {
                let errors = |samples| errors(*model, samples, *source, kind, &calibration);
                let Some((without, errors)) = errors(isotropic).zip(errors(anisotropic)) else { continue };
                let mean = |i: usize, j: usize| {
                    errors.iter().map(|(_, e)| e[i] * e[j]).sum::<f64>() / errors.len() as f64
                };
                learned.push(ModelDiscrepancy {
                    model: model.name().to_owned(),
                    coordination_kind: kind,
                    gamma: model.uses_gamma().then_some(*source),
                    mean_square: std::array::from_fn(|i| std::array::from_fn(|j| mean(i, j))),
                    by_eps: by_eps(&without, &errors),
                });
            }
        }
    }
    learned
}

/// ε inferred, and the errors of coordination number, k̂ and ε.
type Errors = Vec<(f64, [f64; 3])>;

/// Errors on the packings that the model solves; `None` if these are fewer than nine in ten.
fn errors(
    model: &dyn Model,
    samples: &[CalibrationSample],
    gamma: StrainRatioSource,
    kind: InferredQuantity,
    calibration: &Calibration,
) -> Option<Errors> {
    let error = |s: &CalibrationSample| -> Result<Option<(f64, [f64; 3])>, EmtError> {
        let point = model.solve(&s.observation(gamma).checked()?, calibration)?;
        if point.discrepancy.is_some() {
            return Ok(None);
        }
        let found = point.structure;
        let truth = if kind == InferredQuantity::Z { s.z } else { s.k };
        let k_hat = found.k_hat.map_or(0.0, |k_hat| k_hat - truth);
        let both = found.get(kind).zip(found.eps);
        Ok(both.map(|(n, eps)| (eps, [n - truth, k_hat, eps - s.eps])))
    };
    let known =
        |s: &&CalibrationSample| gamma == StrainRatioSource::Zero || StrainRatio::is_known(&s.gamma, gamma);
    let asked: Vec<_> = samples.iter().filter(known).collect();
    let errors: Errors = asked.iter().filter_map(|s| error(s).ok().flatten()).collect();
    (!errors.is_empty() && errors.len() * 10 >= asked.len() * 9).then_some(errors)
}

/// How the square of the error of ε grows with the inferred ε: f0 + f1 ε², with f0 from isotropic packings and a mean
/// of 1 over anisotropic ones.
fn by_eps(without: &Errors, with: &Errors) -> [f64; 2] {
    let mean = |errors: &Errors, f: fn(f64, f64) -> f64| {
        errors.iter().map(|(eps, e)| f(*eps, e[2])).sum::<f64>() / errors.len() as f64
    };
    let error = mean(with, |_, e| e * e);
    let square = mean(with, |eps, _| eps * eps);
    let constant = (mean(without, |_, e| e * e) / error).min(1.0);
    if constant.is_finite() && square > 0.0 { [constant, (1.0 - constant) / square] } else { [1.0, 0.0] }
}
