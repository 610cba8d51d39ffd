//! Inferred values beside counted ones.

use crate::inference::{Inference, by_origin};
use crate::read_back::InvertedPacking;
use grainlab_core::results::{InferredQuantity, PackingReport};

/// Standard deviations within which 95 % of a normal distribution lie.
const NORMAL_95: f64 = 1.96;

/// An inferred value beside the counted one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Quantity that is judged.
    pub quantity: InferredQuantity,
    /// Value that was inferred.
    pub inferred: f64,
    /// Value that was counted.
    pub counted: f64,
    /// Standard deviation of the inferred value, if it has one above 0.
    pub sigma: Option<f64>,
    /// Interval of the inferred value at its level, or by its standard deviation at 95 %.
    pub interval: Option<[f64; 2]>,
}

impl Judged {
    /// The values that a result has, beside those of the packing.
    pub fn of(result: &Inference, truth: &PackingReport) -> Vec<Self> {
        let judged = |quantity| {
            let (inferred, counted) = (result.values[quantity]?, truth.counted(quantity)?);
            let sigma = result.sigma(quantity).filter(|s| *s > 0.0);
            let by_sigma = sigma.map(|s| [inferred - NORMAL_95 * s, inferred + NORMAL_95 * s]);
            let interval = result.interval.bounds[quantity].or(by_sigma);
            Some(Self { quantity, inferred, counted, sigma, interval })
        };
        InferredQuantity::countable().filter_map(judged).collect()
    }

    /// True if the interval contains the counted value; `None` without an interval.
    pub fn is_inside(&self) -> Option<bool> {
        self.interval.map(|[low, high]| (low..=high).contains(&self.counted))
    }

    /// Distance from the counted value: `−0.108, 1.7 σ`.
    pub fn distance(&self) -> String {
        let off = self.inferred - self.counted;
        let digits = self.quantity.digits();
        let off = format!("{off:+.digits$}").replace('-', "−");
        format!("{off}{}", self.sigmas().map_or_else(String::new, |s| format!(", {s:.1} σ")))
    }

    /// Distance from the counted value in standard deviations.
    pub(super) fn sigmas(&self) -> Option<f64> {
        self.sigma.map(|s| ((self.inferred - self.counted) / s).abs())
    }

    /// `z 4.712 ± 0.034 (counted 4.726, 0.4 σ away)`.
    pub(super) fn words(&self) -> String {
        let (symbol, digits) = (self.quantity.symbol(), self.quantity.digits());
        let away = self.sigmas().map_or_else(String::new, |s| format!(", {s:.1} σ away"));
        format!("{symbol} {} (counted {:.digits$}{away})", self.value(), self.counted)
    }

    /// The value with its standard deviation: `4.712 ± 0.034`.
    pub fn value(&self) -> String {
        let digits = self.quantity.digits();
        let sigma = self.sigma.map_or_else(String::new, |s| format!(" ± {s:.digits$}"));
        format!("{:.digits$}{sigma}", self.inferred).replace('-', "−")
    }
}

/// The recommended result of a state, of the data that were inverted first.
pub fn recommended(state: &InvertedPacking) -> Option<&Inference> {
    by_origin(&state.results).iter().find_map(|(_, results)| Inference::recommended(results))
}
