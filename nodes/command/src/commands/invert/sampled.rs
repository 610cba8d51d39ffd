//! Estimates as samples of their distribution.

use super::case::Case;
use super::state::State;
use grainlab_console::{Table, fixed};
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{CREDIBLE_LEVEL, EmtError, Estimate, MonteCarlo, SamplingSettings, monte_carlo};
use rayon::prelude::*;
use serde::Serialize;

/// One quantity of one model.
#[derive(Debug, Serialize)]
pub(super) struct Sampled {
    model: &'static str,
    calibration: String,
    quantity: &'static str,
    draws: usize,
    /// Number of draws without a solution; all other numbers refer to the rest.
    unsolved: usize,
    mean: Option<f64>,
    sigma: Option<f64>,
    median: Option<f64>,
    /// Probability of the interval.
    level: f64,
    interval: Option<[f64; 2]>,
    /// 0 if both parts of the interval have the same length, 1 if all of it lies above the median, -1 below.
    skewness: Option<f64>,
}

/// Everything with an estimate, sampled.
pub(super) fn sampled(
    state: &State,
    outcomes: &[Result<Estimate, EmtError>],
    cases: &[Case],
    draws: usize,
    seed: u64,
) -> Vec<Sampled> {
    let settings = SamplingSettings { draws, seed };
    let found: Vec<_> = cases.iter().zip(outcomes).filter_map(|(w, o)| o.is_ok().then_some(w)).collect();
    // An estimate always has samples: without errors of the data the flag is refused.
    let samples: Vec<_> = found.par_iter().filter_map(|case| of_case(state, case, settings).ok()).collect();
    samples.iter().flat_map(of_samples).collect()
}

fn of_case(state: &State, case: &Case, settings: SamplingSettings) -> Result<MonteCarlo, EmtError> {
    monte_carlo(case.model, &state.observation(case)?, &case.calibration, settings)
}

fn of_samples(samples: &MonteCarlo) -> Vec<Sampled> {
    let determined = InferredQuantity::ALL.into_iter().filter(|q| samples.mean.get(*q).is_some());
    let one = |quantity: InferredQuantity| Sampled {
        model: samples.model,
        calibration: samples.calibration.clone(),
        quantity: quantity.name(),
        draws: samples.draws,
        unsolved: samples.unsolved,
        mean: samples.mean.get(quantity),
        sigma: samples.stddev(quantity),
        median: samples.quantile(quantity, 0.5),
        level: CREDIBLE_LEVEL,
        interval: samples.interval(quantity),
        skewness: samples.skewness(quantity),
    };
    determined.map(one).collect()
}

/// As a text table.
pub(super) fn people(sampled: &[Sampled]) -> String {
    let level = format!("{} %", 100.0 * CREDIBLE_LEVEL);
    let columns = ["model", "sampled", "mean", "sigma", "median", &format!("{level} from"), "to", "skewness"];
    let mut t = Table::new(columns.into_iter().chain(["without solution"]));
    for s in sampled {
        let digits = if s.quantity.starts_with("eps") { 4 } else { 3 };
        let [low, high] = [s.interval.map(|i| i[0]), s.interval.map(|i| i[1])];
        let numbers = [s.mean, s.sigma, s.median, low, high].map(|v| fixed(v, digits));
        let unsolved = format!("{:.1} %", 100.0 * s.unsolved as f64 / s.draws as f64);
        let labels = [s.model, s.quantity].map(str::to_owned);
        t.row(labels.into_iter().chain(numbers).chain([fixed(s.skewness, 2), unsolved]));
    }
    format!("\n{}", t.without_empty_columns().text())
}
