//! The prior density of one quantity.

use super::error::PriorError;
use super::quadrature::{Tilted, integrated};
use crate::normal;

/// ln of the smallest probability between the limits of a prior.
const LEAST: f64 = -690.0;

/// Smallest standard deviation over the mean (or 1, if that is larger) that differs from rounding.
const NARROWEST: f64 = 1e-13;

/// Magnitude above which no number is meant.
const LARGEST: f64 = 1e100;

/// A normal density, a uniform one, or a normal one between two limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Density {
    /// Mean and standard deviation of the normal density; `None`: uniform.
    normal: Option<[f64; 2]>,
    /// Lowest and highest value; infinite: no limit.
    range: [f64; 2],
    /// ln of the integral of the density before it is normalised.
    ln_mass: f64,
}

impl Density {
    /// A normal density; the standard deviation is positive.
    pub fn normal(mean: f64, stddev: f64) -> Result<Self, PriorError> {
        Self::truncated(mean, stddev, [f64::NEG_INFINITY, f64::INFINITY])
    }

    /// A uniform density between two finite limits.
    pub fn uniform(low: f64, high: f64) -> Result<Self, PriorError> {
        ordered([low, high])?;
        if !(is_usual(low) && is_usual(high)) {
            return Err(PriorError::NotFinite);
        }
        Ok(Self { normal: None, range: [low, high], ln_mass: (high - low).ln() })
    }

    /// A normal density between two limits, which may be infinite; mean and standard deviation are those without limits.
    pub fn truncated(mean: f64, stddev: f64, range: [f64; 2]) -> Result<Self, PriorError> {
        let limits_are_usual = range.iter().all(|limit| limit.is_infinite() || is_usual(*limit));
        if !(is_usual(mean) && is_usual(stddev) && limits_are_usual) {
            return Err(PriorError::NotFinite);
        }
        ordered(range)?;
        if stddev < NARROWEST * mean.abs().max(1.0) {
            return Err(PriorError::ZeroWidth { stddev });
        }
        let ln_mass = integrated(mean, stddev, range).ln_mass;
        // Also where it is not a number.
        if ln_mass.is_nan() || ln_mass < LEAST {
            return Err(PriorError::Empty { mean, stddev, low: range[0], high: range[1] });
        }
        Ok(Self { normal: Some([mean, stddev]), range, ln_mass })
    }

    /// Mean and standard deviation of the normal density before it is limited; `None` for a uniform one.
    pub fn of_normal(&self) -> Option<[f64; 2]> {
        self.normal
    }

    /// Lowest and highest value; infinite where there is no limit.
    pub fn range(&self) -> [f64; 2] {
        self.range
    }

    /// The range that contains all but 1e-20 of the probability.
    pub(crate) fn effective_range(&self) -> [f64; 2] {
        let Some([mean, stddev]) = self.normal else { return self.range };
        let [low, high] = self.range;
        let nearest = mean.clamp(low, high);
        let reach = ((nearest - mean).powi(2) + 92.0 * stddev * stddev).sqrt();
        [low.max(mean - reach), high.min(mean + reach)]
    }

    /// ln of the density at x; −∞ outside the limits.
    pub fn ln(&self, x: f64) -> f64 {
        let [low, high] = self.range;
        if !(low..=high).contains(&x) {
            return f64::NEG_INFINITY;
        }
        self.normal.map_or(0.0, |[mean, stddev]| normal::ln_density(x, mean, stddev)) - self.ln_mass
    }

    /// Mean of the density.
    pub fn mean(&self) -> f64 {
        self.moments()[0]
    }

    /// Standard deviation of the density.
    pub fn stddev(&self) -> f64 {
        self.moments()[1].sqrt()
    }

    /// Mean and variance.
    pub(crate) fn moments(&self) -> [f64; 2] {
        let [low, high] = self.range;
        match self.normal {
            None => [0.5 * (low + high), (high - low).powi(2) / 12.0],
            Some([mean, stddev]) if low.is_infinite() && high.is_infinite() => [mean, stddev * stddev],
            Some([mean, stddev]) => {
                let found = integrated(mean, stddev, self.range);
                [found.mean.clamp(low, high), found.variance]
            }
        }
    }

    /// The value below which the probability is `p`, 0 to 1.
    pub fn quantile(&self, p: f64) -> f64 {
        let [low, high] = self.range;
        let Some([mean, stddev]) = self.normal else { return low + p * (high - low) };
        let [a, b] = self.range.map(|v| (v - mean) / stddev);
        // Far above the mean the probabilities below differ from 1 by less than rounding: the mirror image has them.
        let x = if a > 0.0 {
            -normal::quantile(normal::below(-b) + (1.0 - p) * (normal::below(-a) - normal::below(-b)))
        } else {
            normal::quantile(normal::below(a) + p * (normal::below(b) - normal::below(a)))
        };
        (mean + stddev * x).clamp(low, high)
    }

    /// Density between these limits, too; `None` where less than 1e-9 of the probability is left.
    pub(crate) fn within(&self, [low, high]: [f64; 2]) -> Option<Self> {
        let range = [self.range[0].max(low), self.range[1].min(high)];
        let limited = match self.normal {
            None => Self::uniform(range[0], range[1]),
            Some([mean, stddev]) => Self::truncated(mean, stddev, range),
        };
        limited.ok().filter(|l| l.ln_mass - self.ln_mass > 1e-9f64.ln())
    }

    /// Multiplied by a normal density of this mean and variance.
    pub(crate) fn tilted(&self, mean: f64, variance: f64) -> Tilted {
        let (at, spread, ln_overlap) = match self.normal {
            None => (mean, variance, 0.0),
            Some([own, stddev]) => {
                let own_variance = stddev * stddev;
                let sum = variance + own_variance;
                let at = (mean * own_variance + own * variance) / sum;
                (at, variance * own_variance / sum, normal::ln_density(mean, own, sum.sqrt()))
            }
        };
        let [low, high] = self.range;
        if low.is_infinite() && high.is_infinite() {
            return Tilted { ln_mass: ln_overlap - self.ln_mass, mean: at, variance: spread };
        }
        let found = integrated(at, spread.sqrt(), self.range);
        Tilted { ln_mass: ln_overlap + found.ln_mass - self.ln_mass, ..found }
    }
}

/// True if a number is finite, and its square, too.
fn is_usual(number: f64) -> bool {
    number.abs() < LARGEST
}

fn ordered([low, high]: [f64; 2]) -> Result<(), PriorError> {
    if low.is_nan() || high.is_nan() {
        return Err(PriorError::NotFinite);
    }
    if low == high {
        return Err(PriorError::SameLimits { at: low });
    }
    if low > high { Err(PriorError::Inverted { low, high }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_normal_density_has_its_known_moments() {
        let d = Density::truncated(0.0, 2.0, [0.0, f64::INFINITY]).unwrap();
        let mean = 2.0 * (2.0 / std::f64::consts::PI).sqrt();
        assert!((d.mean() - mean).abs() < 1e-12);
        assert!((d.stddev().powi(2) - 4.0 * (1.0 - 2.0 / std::f64::consts::PI)).abs() < 1e-12);
        assert!((d.ln(1.0) - (normal::ln_density(1.0, 0.0, 2.0) + 2f64.ln())).abs() < 1e-12);
        assert!((d.quantile(0.5) - 2.0 * normal::quantile(0.75)).abs() < 1e-12);
    }

    #[test]
    fn a_narrow_range_far_in_the_tail_keeps_its_mean_and_variance() {
        // Exponential of rate 30 per unit there.
        let d = Density::truncated(0.0, 1.0, [30.0, f64::INFINITY]).unwrap();
        assert!(
            (d.mean() - 30.033_259).abs() < 1e-6 && (d.stddev() - 0.033_222_7).abs() < 1e-6,
            "{}",
            d.stddev()
        );
        let narrow = Density::uniform(4.8, 4.8 + 1e-9).unwrap().tilted(4.0, 1.0);
        assert!((narrow.variance.sqrt() / (1e-9 / 12f64.sqrt()) - 1.0).abs() < 1e-6, "{narrow:?}");
    }

    #[test]
    fn the_product_of_two_normal_densities_is_the_known_one() {
        let t = Density::normal(1.0, 2.0).unwrap().tilted(3.0, 1.0);
        assert!((t.mean - 2.6).abs() < 1e-14 && (t.variance - 0.8).abs() < 1e-14);
        assert!((t.ln_mass - normal::ln_density(3.0, 1.0, 5f64.sqrt())).abs() < 1e-14);
        // Limits far away change nothing.
        let limited = Density::truncated(1.0, 2.0, [-1e3, 1e3]).unwrap().tilted(3.0, 1.0);
        assert!((limited.mean - t.mean).abs() < 1e-13 && (limited.variance - t.variance).abs() < 1e-13);
        assert!((limited.ln_mass - t.ln_mass).abs() < 1e-12);
    }

    #[test]
    fn a_density_of_no_width_or_with_limits_in_the_wrong_order_is_refused() {
        assert!(matches!(Density::uniform(1.0, 1.0), Err(PriorError::SameLimits { .. })));
        assert!(matches!(Density::uniform(2.0, 1.0), Err(PriorError::Inverted { .. })));
        assert!(matches!(Density::normal(0.0, 0.0), Err(PriorError::ZeroWidth { .. })));
        assert!(matches!(Density::normal(f64::NAN, 1.0), Err(PriorError::NotFinite)));
        assert!(matches!(Density::uniform(f64::NAN, 1.0), Err(PriorError::NotFinite)));
        assert!(Density::uniform(0.0, 1.0).unwrap().within([2.0, 3.0]).is_none());
    }
}
