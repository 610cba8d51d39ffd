//! The observation against what the model predicts: posterior predictive checks (Gelman, Meng & Stern 1996).
//!
//! The posterior has seen each modulus, so that its predictive probabilities are too near to ½: small ones count, large ones say
//! nothing. A modulus predicted from the others has not been seen, and its probability is uniform where the model holds.

use super::halton;
use super::points::{Posterior, point};
use super::proposal::Proposal;
use super::target::TargetValue;
use crate::estimate::Inversion;
use crate::likelihood::Predicted;
use crate::moduli::Modulus;
use crate::normal;
use grainlab_core::notes::{Note, Status};

/// Probability below which an observation counts as unlike what the model predicts.
const UNLIKELY: f64 = 1e-3;

/// Number of points of the integration without a modulus.
const POINTS: u64 = 4096;

/// Effective number of points below which a modulus left out is not predicted.
const FEWEST: f64 = 30.0;

/// Check of one modulus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModulusCheck {
    /// The modulus that is checked.
    pub modulus: Modulus,
    /// Observed value, Pa.
    pub observed: f64,
    /// Probability of a value as extreme as the observed one, two-sided, under the posterior of all moduli.
    pub predictive: f64,
    /// Probability under the posterior of the other moduli; `None` where they do not predict it.
    pub left_out: Option<f64>,
}

/// The whole observation.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Check of each modulus.
    pub moduli: Vec<ModulusCheck>,
    /// Probability of a χ² of all moduli as large as the observed one, under the posterior.
    pub chi_square: f64,
}

impl Check {
    /// True if the observation is unlike what the model predicts: a probability of less than one in a thousand.
    pub fn is_unlikely(&self) -> bool {
        self.probability() < UNLIKELY
    }

    /// The lower of the probability of χ² and of the least probable modulus left out times the number of moduli.
    fn probability(&self) -> f64 {
        let least = self.least().and_then(|m| m.left_out).unwrap_or(1.0);
        self.chi_square.min(least * self.moduli.len() as f64)
    }

    /// Marks an estimate of the same observation as contradictory, if the observation is unlikely and nothing else says so.
    pub fn apply(&self, inversion: &mut Inversion) {
        if self.is_unlikely() && Status::of(&inversion.notes) < Status::Contradictory {
            inversion.add(Note::improbable(self.probability()));
        }
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
            let sides = |sign: f64| self.expected(|p| normal::below(sign * p.at.predicted.sigma(modulus)));
            ModulusCheck {
                modulus,
                observed,
                predictive: two_sided([1.0, -1.0].map(sides)),
                left_out: self.left_out(modulus).map(two_sided),
            }
        };
        let moduli: Vec<_> = self.observed().into_iter().map(one).collect();
        let chi_square =
            self.expected(|p| normal::chi_square_above(p.at.predicted.chi_square(), p.at.predicted.count));
        Check { moduli, chi_square }
    }

    /// Probabilities of a smaller and of a larger value of one modulus, given the others.
    fn left_out(&self, modulus: Modulus) -> Option<[f64; 2]> {
        if self.observed().len() < 2 {
            return None;
        }
        // The others may determine far less: points of their own.
        let given_others = |predicted: &Predicted| predicted.given_others(modulus);
        let ln = |at: &TargetValue| at.ln() - given_others(&at.predicted).0;
        let proposal = Proposal::about(&self.target, ln).ok()?;
        let weighted = |index: u64| {
            let found = point(&self.target, &proposal, 0, &halton::point(index, &[0.5; 6]))?;
            let (ln, sigma) = given_others(&found.at.predicted);
            Some((found.ln_weight - ln, sigma))
        };
        let without: Vec<(f64, f64)> = (0..POINTS).filter_map(weighted).collect();
        let highest = without.iter().map(|(ln, _)| *ln).fold(f64::NEG_INFINITY, f64::max);
        let (mut sum, mut squares, mut sides) = (0.0, 0.0, [0.0; 2]);
        for (ln, sigma) in without {
            let w = (ln - highest).exp();
            sum += w;
            squares += w * w;
            sides[0] += w * normal::below(sigma);
            sides[1] += w * normal::below(-sigma);
        }
        (sum * sum / squares >= FEWEST).then_some(sides.map(|side| side / sum))
    }
}

fn two_sided([below, above]: [f64; 2]) -> f64 {
    (2.0 * below.min(above)).min(1.0)
}
