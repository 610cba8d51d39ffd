//! What the models infer, with the stable keys of `results[]`.

use crate::output::{Table, exact, fixed};
use emt::{CREDIBLE_LEVEL, EmtError, Estimate};
use grainlab_msgs::boundary::{EstimateReading, EstimateStatus};
use grainlab_msgs::msg;
use serde::Serialize;

/// One model's result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Inference {
    /// Name of the model.
    pub(crate) model: String,
    /// Name of the isotropic calibration.
    pub(crate) calibration: String,
    /// Coordination number, in the calibration's sense.
    pub(crate) k: Option<f64>,
    /// Coordination number of the equivalent isotropic packing.
    pub(crate) k_hat: Option<f64>,
    /// Coordination number without rattlers; the paper's models do not give it.
    pub(crate) z: Option<f64>,
    /// Contact anisotropy.
    pub(crate) eps: Option<f64>,
    /// Standard deviations.
    pub(crate) sigma: Triple<Option<f64>>,
    /// Credible intervals.
    pub(crate) interval: Interval,
    /// `ok`, `extrapolated`, `undetermined` or `failed`.
    pub(crate) status: &'static str,
    /// The strain ratio that the model was fed with, and which of the three it is.
    pub(crate) gamma_over_delta: Option<f64>,
    pub(crate) gamma_over_delta_source: Option<String>,
    /// For a reader.
    pub(crate) warnings: Vec<String>,
}

/// One value for each of k, k̂ and ε.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Triple<T> {
    pub(crate) k: T,
    pub(crate) k_hat: T,
    pub(crate) eps: T,
}

/// Central intervals, low and high.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Interval {
    /// Probability inside each.
    pub(crate) level: Option<f64>,
    #[serde(flatten)]
    pub(crate) bounds: Triple<Option<[f64; 2]>>,
}

impl Inference {
    /// A model that has no estimate, and why.
    pub(crate) fn failed(
        model: &str,
        calibration: &str,
        status: &'static str,
        warnings: Vec<String>,
    ) -> Self {
        Self {
            model: model.to_owned(),
            calibration: calibration.to_owned(),
            k: None,
            k_hat: None,
            z: None,
            eps: None,
            sigma: Triple::default(),
            interval: Interval::default(),
            status,
            gamma_over_delta: None,
            gamma_over_delta_source: None,
            warnings,
        }
    }

    /// What was read from a recording: the message, and the same checked.
    pub(crate) fn of_reading(message: &msg::Estimate, e: &EstimateReading) -> Self {
        let status = match e.status {
            EstimateStatus::Ok => "ok",
            EstimateStatus::Extrapolated => "extrapolated",
            EstimateStatus::Undetermined => "undetermined",
            EstimateStatus::Failed => "failed",
        };
        let mut inference = Self::failed(&e.model, &e.calibration, status, e.warnings.clone());
        inference.gamma_over_delta = Some(message.gamma_over_delta);
        inference.gamma_over_delta_source = Some(message.gamma_over_delta_source.clone());
        let Some(found) = &e.inferred else { return inference };
        (inference.k, inference.k_hat, inference.eps) = (Some(found.k), Some(found.k_hat), Some(found.eps));
        if let Some(c) = &found.covariance {
            let sigma = |i: usize| Some(c[4 * i].max(0.0).sqrt());
            inference.sigma = Triple { k: sigma(0), k_hat: sigma(1), eps: sigma(2) };
        }
        if let Some(i) = &found.interval {
            let pair = |(low, high): (f64, f64)| Some([low, high]);
            let bounds = Triple { k: pair(i.k), k_hat: pair(i.k_hat), eps: pair(i.eps) };
            inference.interval = Interval { level: Some(i.level), bounds };
        }
        inference
    }

    /// What a model of the kernel says.
    pub(crate) fn of(model: &str, calibration: &str, outcome: &Result<Estimate, EmtError>) -> Self {
        let estimate = match outcome {
            Ok(estimate) => estimate,
            Err(e) => return Self::failed(model, calibration, "failed", vec![e.to_string()]),
        };
        let s = &estimate.structure;
        let sigma = estimate.stddev();
        let interval = estimate.interval();
        Self {
            model: estimate.model.to_owned(),
            calibration: estimate.calibration.clone(),
            k: Some(s.k),
            k_hat: Some(s.k_hat),
            z: None,
            eps: Some(s.eps),
            sigma: sigma.map_or_else(Triple::default, |[k, k_hat, eps]| Triple {
                k: Some(k),
                k_hat: Some(k_hat),
                eps: Some(eps),
            }),
            interval: interval.map_or_else(Interval::default, |[k, k_hat, eps]| Interval {
                level: Some(CREDIBLE_LEVEL),
                bounds: Triple { k: Some(k), k_hat: Some(k_hat), eps: Some(eps) },
            }),
            status: match estimate.status {
                emt::Status::Ok => "ok",
                emt::Status::Extrapolated => "extrapolated",
            },
            gamma_over_delta: Some(estimate.gamma.value),
            gamma_over_delta_source: Some(estimate.gamma.source.name().to_owned()),
            warnings: estimate.warnings.iter().map(ToString::to_string).collect(),
        }
    }

    /// Names of the cells of [`Inference::cells`].
    pub(crate) const COLUMNS: [&str; 9] =
        ["model", "calibration", "k", "sigma", "k_hat", "sigma", "eps", "sigma", "status"];

    /// As cells for people.
    pub(crate) fn cells(&self) -> Vec<String> {
        let pair = |value, sigma, digits| [fixed(value, digits), fixed(sigma, digits)];
        let mut cells = vec![self.model.clone(), self.calibration.clone()];
        cells.extend(pair(self.k, self.sigma.k, 3));
        cells.extend(pair(self.k_hat, self.sigma.k_hat, 3));
        cells.extend(pair(self.eps, self.sigma.eps, 4));
        cells.push(self.status.to_owned());
        cells
    }

    /// Names of the cells of [`Inference::exact_cells`].
    pub(crate) const EXACT_COLUMNS: [&str; 16] = [
        "model",
        "calibration",
        "k",
        "k_hat",
        "z",
        "eps",
        "sigma_k",
        "sigma_k_hat",
        "sigma_eps",
        "k_low",
        "k_high",
        "k_hat_low",
        "k_hat_high",
        "eps_low",
        "eps_high",
        "status",
    ];

    /// As cells at full precision.
    pub(crate) fn exact_cells(&self) -> Vec<String> {
        let s = &self.sigma;
        let mut cells = vec![self.model.clone(), self.calibration.clone()];
        cells.extend([self.k, self.k_hat, self.z, self.eps, s.k, s.k_hat, s.eps].map(exact));
        let b = &self.interval.bounds;
        for bound in [b.k, b.k_hat, b.eps] {
            cells.extend([bound.map(|b| b[0]), bound.map(|b| b[1])].map(exact));
        }
        cells.push(self.status.to_owned());
        cells
    }
}

/// The warnings of several results as lines, each with the models it comes from.
pub(crate) fn warning_lines(results: &[Inference]) -> String {
    let mut seen: Vec<(&str, Vec<&str>)> = Vec::new();
    for r in results {
        for w in &r.warnings {
            match seen.iter_mut().find(|(known, _)| known == w) {
                Some((_, models)) => models.push(&r.model),
                None => seen.push((w, vec![&r.model])),
            }
        }
    }
    seen.iter().map(|(text, models)| format!("  {}: {text}\n", models.join(", "))).collect()
}

/// Results as a table for people, warnings below.
pub(crate) fn table(results: &[Inference]) -> String {
    let mut t = Table::new(Inference::COLUMNS);
    results.iter().for_each(|r| t.row(r.cells()));
    t.text() + &warning_lines(results)
}
