//! The observation against what the model predicts: posterior predictive checks (Gelman, Meng & Stern 1996).
//!
//! The posterior has seen each modulus, so that its predictive probabilities are too near to ½: small ones count, large ones say
//! nothing. A modulus predicted from the others has not been seen, and its probability is uniform where the model holds.

use super::points::Posterior;
use crate::moduli::Modulus;
use crate::normal;

/// Probability below which an observation counts as unlike what the model knows.
const UNLIKELY: f64 = 1e-3;

/// Effective number of points below which a modulus left out is not predicted.
const FEWEST: f64 = 30.0;

/// One modulus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModulusCheck {
    /// Which.
    pub modulus: Modulus,
    /// Observed, Pa.
    pub observed: f64,
    /// Probability of a value as extreme as the observed one, two-sided, under the posterior of all moduli.
    pub predictive: f64,
    /// The same under the posterior of the other moduli; `None` where they do not predict it.
    pub left_out: Option<f64>,
}

/// The whole observation.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Each modulus.
    pub moduli: Vec<ModulusCheck>,
    /// Probability of a χ² of all moduli as large as the observed one, under the posterior.
    pub chi_square: f64,
}

impl Check {
    /// Whether the observation is unlike what the model knows: a probability of less than one in a thousand, that of the moduli
    /// left out divided by their number.
    pub fn is_unlikely(&self) -> bool {
        let each = UNLIKELY / self.moduli.len() as f64;
        self.chi_square < UNLIKELY || self.moduli.iter().filter_map(|m| m.left_out).any(|p| p < each)
    }

    /// The smallest probability of a modulus left out.
    pub fn least(&self) -> Option<&ModulusCheck> {
        let known = self.moduli.iter().filter(|m| m.left_out.is_some());
        known.min_by(|a, b| a.left_out.unwrap_or(1.0).total_cmp(&b.left_out.unwrap_or(1.0)))
    }
}

impl Posterior<'_> {
    /// The observation against its prediction.
    pub fn check(&self) -> Check {
        let one = |(modulus, observed): (Modulus, f64)| {
            let above = self.expected(|p| normal::below(-p.at.predicted.sigma(modulus)));
            ModulusCheck {
                modulus,
                observed,
                predictive: two_sided(above),
                left_out: self.left_out(modulus).map(two_sided),
            }
        };
        let moduli: Vec<_> = self.observed().into_iter().map(one).collect();
        let chi_square =
            self.expected(|p| normal::chi_square_above(p.at.predicted.chi_square(), p.at.predicted.count));
        Check { moduli, chi_square }
    }

    /// Probability of a larger value of one modulus, given the others.
    fn left_out(&self, modulus: Modulus) -> Option<f64> {
        if self.observed().len() < 2 {
            return None;
        }
        let without: Vec<(f64, f64)> = self
            .points
            .iter()
            .map(|p| {
                let (ln, sigma) = p.at.predicted.given_others(modulus);
                (p.ln_weight - ln, sigma)
            })
            .collect();
        let highest = without.iter().map(|(ln, _)| *ln).fold(f64::NEG_INFINITY, f64::max);
        let (mut sum, mut squares, mut above) = (0.0, 0.0, 0.0);
        for (ln, sigma) in without {
            let w = (ln - highest).exp();
            sum += w;
            squares += w * w;
            above += w * normal::below(-sigma);
        }
        (sum * sum / squares >= FEWEST).then_some(above / sum)
    }
}

fn two_sided(above: f64) -> f64 {
    (2.0 * above.min(1.0 - above)).clamp(0.0, 1.0)
}
