//! Independent draws from the posterior.

use super::points::{Posterior, point};
use crate::error::EmtError;
use crate::moduli::Modulus;
use crate::random::Random;
use grainlab_core::results::{InferredQuantity, Microstructure};

/// Margin of the logarithm of the envelope above the largest weight found by the integration.
const MARGIN: f64 = 0.2;

/// Proposals per draw beyond which rejection is given up.
const MOST_PROPOSALS: usize = 2000;

/// One draw from the posterior.
#[derive(Clone, Debug, PartialEq)]
pub struct Draw {
    /// The unknowns, and what follows from them.
    pub structure: Microstructure,
    /// ln of the density of all moduli (in MPa).
    pub ln_likelihood: f64,
    /// ln of the density of the prior.
    pub ln_prior: f64,
    /// ln of the density of each modulus (in MPa) given the others, for leaving them out one by one.
    pub ln_likelihood_by_modulus: Vec<f64>,
    /// Moduli drawn for this structure with all errors, Pa: posterior predictive.
    pub replicated: Vec<f64>,
}

/// Draws from a posterior.
#[derive(Clone, Debug, PartialEq)]
pub struct Draws {
    /// The quantities of each draw.
    pub quantities: Vec<InferredQuantity>,
    /// The moduli of the likelihood and their observed values, Pa.
    pub observed: Vec<(Modulus, f64)>,
    /// Draws from the posterior.
    pub draws: Vec<Draw>,
    /// Share of the proposals that were accepted.
    pub acceptance: f64,
    /// Number of times that a proposal exceeded the envelope, which was raised then, and all draws made anew.
    pub raised: usize,
}

impl Posterior<'_> {
    /// So many independent draws, the same for the same seed.
    pub fn draws(&self, count: usize) -> Result<Draws, EmtError> {
        let observed = self.observed();
        // Other numbers than those of the integration.
        let mut random = Random::new(self.seed ^ 0x9e37_79b9_7f4a_7c15);
        let (mut draws, mut proposed, mut raised) = (Vec::with_capacity(count), 0, 0);
        let mut envelope = self.highest + MARGIN;
        while draws.len() < count {
            if proposed >= MOST_PROPOSALS * (draws.len() + 100) {
                return Err(EmtError::NotSampled {
                    model: self.target.model,
                    reason: "rejection accepts too few draws: the data contradict the prior, or determine too little; widen \
                             the prior",
                });
            }
            proposed += 1;
            let uniform: [f64; 6] = std::array::from_fn(|_| random.uniform());
            let accept = random.uniform();
            let Some(found) = point(&self.target, &self.proposal, 0, &uniform) else { continue };
            if found.ln_weight > envelope {
                (envelope, raised) = (found.ln_weight + MARGIN, raised + 1);
                (draws, proposed) = (Vec::with_capacity(count), 0);
                continue;
            }
            if accept.ln() > found.ln_weight - envelope {
                continue;
            }
            let normal = random.normal();
            let (predicted, structure) = (&found.at.predicted, &found.structure);
            let replicated = predicted.replicated(&normal);
            let of_following = self.target.likelihood.following().iter().zip(&self.target.following);
            let following: f64 =
                of_following.filter_map(|(q, d)| Some((*d)?.ln(structure[*q as usize]))).sum();
            draws.push(Draw {
                structure: self
                    .quantities()
                    .into_iter()
                    .fold(Microstructure::default(), |all, q| all.with(q, structure[q as usize])),
                ln_likelihood: found.at.ln_likelihood,
                ln_prior: found.at.ln_prior + following,
                ln_likelihood_by_modulus: observed
                    .iter()
                    .map(|(m, _)| predicted.given_others(*m).0)
                    .collect(),
                replicated: observed.iter().map(|(m, value)| value + replicated[*m as usize]).collect(),
            });
        }
        let acceptance = count as f64 / proposed.max(1) as f64;
        Ok(Draws { quantities: self.quantities(), observed, draws, acceptance, raised })
    }
}
