//! What the models infer, with the stable keys of `results[]`.

use crate::output::{Table, exact, fixed};
use emt::{CREDIBLE_LEVEL, EmtError, Estimate, Quantity};
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
    /// What it infers.
    #[serde(flatten)]
    pub(crate) values: Quantities<Option<f64>>,
    /// Standard deviations.
    pub(crate) sigma: Quantities<Option<f64>>,
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

/// One value for each quantity of the microstructure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Quantities<T> {
    /// Coordination number, in the calibration's sense.
    pub(crate) k: T,
    /// Coordination number of the equivalent isotropic packing.
    pub(crate) k_hat: T,
    /// Coordination number without rattlers; the paper's models do not give it.
    pub(crate) z: T,
    /// Contact anisotropy.
    pub(crate) eps: T,
    /// Contact anisotropy weighted by contact stiffness; the paper's models do not give it.
    pub(crate) eps_stiffness: T,
}

impl<T> Quantities<T> {
    fn of(mut value: impl FnMut(Quantity) -> T) -> Self {
        Self {
            k: value(Quantity::K),
            k_hat: value(Quantity::KHat),
            z: value(Quantity::Z),
            eps: value(Quantity::Eps),
            eps_stiffness: value(Quantity::EpsStiffness),
        }
    }
}

/// Central intervals, low and high.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Interval {
    /// Probability inside each.
    pub(crate) level: Option<f64>,
    #[serde(flatten)]
    pub(crate) bounds: Quantities<Option<[f64; 2]>>,
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
            values: Quantities::default(),
            sigma: Quantities::default(),
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
        (inference.values.k, inference.values.k_hat, inference.values.eps) =
            (Some(found.k), Some(found.k_hat), Some(found.eps));
        if let Some(c) = &found.covariance {
            let sigma = |i: usize| Some(c[4 * i].max(0.0).sqrt());
            (inference.sigma.k, inference.sigma.k_hat, inference.sigma.eps) = (sigma(0), sigma(1), sigma(2));
        }
        if let Some(i) = &found.interval {
            let pair = |(low, high): (f64, f64)| Some([low, high]);
            let none = Quantities::default();
            let bounds = Quantities { k: pair(i.k), k_hat: pair(i.k_hat), eps: pair(i.eps), ..none };
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
        let known = estimate.covariance().is_some();
        Self {
            model: estimate.model.to_owned(),
            calibration: estimate.calibration.clone(),
            values: Quantities::of(|q| estimate.structure.get(q)),
            sigma: Quantities::of(|q| estimate.stddev(q)),
            interval: Interval {
                level: known.then_some(CREDIBLE_LEVEL),
                bounds: Quantities::of(|q| estimate.interval(q)),
            },
            status: match estimate.status {
                emt::Status::Ok => "ok",
                emt::Status::Extrapolated => "extrapolated",
            },
            gamma_over_delta: estimate.gamma.map(|g| g.value),
            gamma_over_delta_source: estimate.gamma.map(|g| g.source.name().to_owned()),
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
        cells.extend(pair(self.values.k, self.sigma.k, 3));
        cells.extend(pair(self.values.k_hat, self.sigma.k_hat, 3));
        cells.extend(pair(self.values.eps, self.sigma.eps, 4));
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
        let (v, s) = (&self.values, &self.sigma);
        let mut cells = vec![self.model.clone(), self.calibration.clone()];
        cells.extend([v.k, v.k_hat, v.z, v.eps, s.k, s.k_hat, s.eps].map(exact));
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
