//! Statistics of the errors of one quantity.

use grainlab_core::notes::Status;
use grainlab_core::results::InferredQuantity;
use grainlab_emt::Inversion;
use serde::{Serialize, Serializer};
use serde_json::json;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Error {
    /// Inversion minus truth; `None` without an estimate.
    error: Option<f64>,
    extrapolated: bool,
    /// Coverage of the truth by the interval; `None` without an interval.
    covered: Option<bool>,
}

impl Error {
    pub(super) fn of(estimate: Option<&Inversion>, quantity: InferredQuantity, truth: f64) -> Self {
        let found = estimate.and_then(|e| Some((e, e.structure.get(quantity)?)));
        Self {
            error: found.map(|(_, value)| value - truth),
            extrapolated: found.is_some_and(|(e, _)| e.status() == Status::Extrapolated),
            covered: found
                .and_then(|(e, _)| e.interval(quantity))
                .map(|[low, high]| (low..=high).contains(&truth)),
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Score {
    /// Rows whose truth is known.
    pub(super) rows: u64,
    /// Rows with an estimate; the numbers below refer to these.
    pub(super) solved: u64,
    /// Estimates outside the range of model or calibration.
    pub(super) extrapolated: u64,
    /// Estimates with an interval.
    pub(super) intervals: u64,
    covered: u64,
    mean: f64,
    /// Sum of squares about the mean.
    squares: f64,
    absolute: f64,
}

impl Score {
    /// Adds one row, in one pass (Welford).
    pub(super) fn add(&mut self, error: &Error) {
        self.rows += 1;
        let Some(value) = error.error else { return };
        self.solved += 1;
        self.extrapolated += u64::from(error.extrapolated);
        self.intervals += u64::from(error.covered.is_some());
        self.covered += u64::from(error.covered == Some(true));
        let off = value - self.mean;
        self.mean += off / self.solved as f64;
        self.squares += off * (value - self.mean);
        self.absolute += value.abs();
    }

    pub(super) fn bias(&self) -> Option<f64> {
        (self.solved > 0).then_some(self.mean)
    }

    /// Standard deviation of two or more errors.
    pub(super) fn scatter(&self) -> Option<f64> {
        (self.solved > 1).then(|| (self.squares / (self.solved - 1) as f64).sqrt())
    }

    pub(super) fn rms(&self) -> Option<f64> {
        Some((self.bias()?.powi(2) + self.squares / self.solved as f64).sqrt())
    }

    pub(super) fn mean_absolute(&self) -> Option<f64> {
        (self.solved > 0).then(|| self.absolute / self.solved as f64)
    }

    /// Fraction of the intervals that contain the truth.
    pub(super) fn coverage(&self) -> Option<f64> {
        (self.intervals > 0).then(|| self.covered as f64 / self.intervals as f64)
    }
}

impl Score {
    /// True if so few intervals contain the truth that it is no chance: fewer than 90 % where 95 % are stated, and less than
    /// once in a thousand in independent rows.
    pub(super) fn is_overconfident(&self) -> bool {
        const STATED: f64 = 0.95;
        const TOO_FEW: f64 = 0.9;
        const CHANCE: f64 = 1e-3;
        self.coverage().is_some_and(|c| c < TOO_FEW)
            && binomial_tail(self.covered, self.intervals, STATED) < CHANCE
    }

    pub(super) fn covered(&self) -> u64 {
        self.covered
    }
}

/// Probability of this number of successes or fewer in `n` trials.
fn binomial_tail(successes: u64, n: u64, probability: f64) -> f64 {
    // From the logarithm of each term, since the first is tiny for many trials.
    let odds = (probability / (1.0 - probability)).ln();
    let mut term = n as f64 * (1.0 - probability).ln();
    let mut sum = term.exp();
    for k in 0..successes.min(n) {
        term += odds + ((n - k) as f64 / (k + 1) as f64).ln();
        sum += term.exp();
    }
    sum.min(1.0)
}

impl Serialize for Score {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map([
            ("rows", json!(self.rows)),
            ("solved", json!(self.solved)),
            ("extrapolated", json!(self.extrapolated)),
            ("bias", json!(self.bias())),
            ("scatter", json!(self.scatter())),
            ("rms", json!(self.rms())),
            ("mean_absolute", json!(self.mean_absolute())),
            ("intervals", json!(self.intervals)),
            ("covered", json!(self.coverage())),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bias_scatter_and_rms_are_those_of_the_errors() {
        let mut score = Score::default();
        // Far from zero, where a plain sum of squares would lose the differences by rounding.
        let errors = [1e6 + 1.0, 1e6 - 2.0, 1e6 + 4.0];
        for (i, value) in errors.into_iter().enumerate() {
            score.add(&Error { error: Some(value), extrapolated: i == 0, covered: Some(i < 2) });
        }
        score.add(&Error { error: None, extrapolated: false, covered: None });
        assert_eq!((score.rows, score.solved, score.extrapolated, score.intervals), (4, 3, 1, 3));
        assert!((score.bias().unwrap() - (1e6 + 1.0)).abs() < 1e-6);
        assert!((score.scatter().unwrap() - 3.0).abs() < 1e-6, "of -0, -3 and 3");
        let rms = (errors.map(|e| e * e).iter().sum::<f64>() / 3.0).sqrt();
        assert!((score.rms().unwrap() - rms).abs() < 1e-6);
        assert_eq!(score.coverage(), Some(2.0 / 3.0));
    }

    #[test]
    fn few_intervals_that_hold_the_truth_are_overconfident_unless_by_chance() {
        // By hand: .05^3 + 3 .95 .05^2, and all.
        assert!((binomial_tail(1, 3, 0.95) - 0.00725).abs() < 1e-12);
        assert!((binomial_tail(2000, 2000, 0.95) - 1.0).abs() < 1e-9);
        let of = |covered, intervals| Score { covered, intervals, ..Score::default() }.is_overconfident();
        assert!(of(0, 16) && of(12, 20) && of(340, 384));
        assert!(!of(14, 16) && !of(0, 1) && !of(350, 384) && !of(0, 0), "by chance, or nearly enough");
    }

    #[test]
    fn nothing_solved_has_no_error() {
        let mut score = Score::default();
        score.add(&Error { error: None, extrapolated: false, covered: None });
        assert_eq!((score.bias(), score.scatter(), score.rms(), score.coverage()), (None, None, None, None));
    }
}
