//! The posterior as weighted points.

use super::halton;
use super::proposal::Proposal;
use super::target::{Target, TargetValue};
use crate::calibration::Calibration;
use crate::error::EmtError;
use crate::likelihood::FOLLOWING;
use crate::model::Model;
use crate::moduli::Modulus;
use crate::normal;
use crate::observation::Observation;
use crate::prior::Prior;
use crate::random::Random;
use grainlab_core::results::{InferredQuantity, Microstructure};
use nalgebra::Vector2;

/// Number of independent shifts of the quasi-random points, whose scatter is the error of an integral.
pub(super) const REPLICATES: usize = 8;

/// Effective number of points below which the posterior counts as not integrated.
const FEWEST: f64 = 30.0;

/// Settings of the integration of a posterior.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PosteriorSettings {
    /// Number of points. With 16,384 the logarithm of the evidence is accurate to 1e-3.
    pub points: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for PosteriorSettings {
    fn default() -> Self {
        Self { points: 16_384, seed: 0 }
    }
}

/// The posterior of one model for one observation.
pub struct Posterior<'a> {
    pub(super) target: Target<'a>,
    pub(super) proposal: Proposal,
    pub(super) prior: Prior,
    pub(super) seed: u64,
    /// Points where the posterior is not 0.
    pub(super) points: Vec<Point>,
    pub(super) proposed: usize,
    /// ln of the largest weight.
    pub(super) highest: f64,
}

pub(super) struct Point {
    pub(super) replicate: usize,
    /// ln of posterior over proposal.
    pub(super) ln_weight: f64,
    pub(super) structure: [f64; InferredQuantity::COUNT],
    pub(super) at: TargetValue,
}

impl<'a> Posterior<'a> {
    /// Posterior of what `model` states for an observation, with a prior; quantities without one have the uniform density over the
    /// domain of the model.
    pub fn new(
        model: &'a dyn Model,
        observation: &Observation,
        calibration: &'a Calibration,
        prior: &Prior,
        settings: PosteriorSettings,
    ) -> Result<Self, EmtError> {
        let prior = prior.completed(&model.prior_domain(calibration))?;
        let target = Target::new(model.name(), model.likelihood(observation, calibration)?, &prior)?;
        let proposal = Proposal::about(&target, TargetValue::ln)?;
        let mut random = Random::new(settings.seed);
        let each = settings.points.div_ceil(REPLICATES);
        let mut points = Vec::with_capacity(settings.points);
        for replicate in 0..REPLICATES {
            let shift = std::array::from_fn(|_| random.uniform());
            for index in 0..each {
                let uniform = halton::point(index as u64, &shift);
                points.extend(point(&target, &proposal, replicate, &uniform));
            }
        }
        let highest = points.iter().map(|p| p.ln_weight).fold(f64::NEG_INFINITY, f64::max);
        let seed = settings.seed;
        let posterior = Self { target, proposal, prior, seed, points, proposed: each * REPLICATES, highest };
        if posterior.effective_points() < FEWEST {
            return Err(EmtError::NotSampled {
                model: model.name(),
                reason: "too few points have a weight: the data determine too little, or contradict the prior; widen the prior",
            });
        }
        Ok(posterior)
    }

    /// The prior, completed for the model.
    pub fn prior(&self) -> &Prior {
        &self.prior
    }

    /// The moduli of the likelihood, and their observed values, Pa.
    pub fn observed(&self) -> Vec<(Modulus, f64)> {
        let likelihood = &self.target.likelihood;
        likelihood.moduli().iter().copied().zip(likelihood.observed()).collect()
    }

    /// The unknowns, and what follows from them.
    pub fn quantities(&self) -> Vec<InferredQuantity> {
        let likelihood = &self.target.likelihood;
        likelihood.unknowns().iter().chain(likelihood.following()).copied().collect()
    }

    /// Number of equally weighted points that would determine means as well: (Σ w)²/Σ w².
    pub fn effective_points(&self) -> f64 {
        let (sum, squares) = self.points.iter().fold((0.0, 0.0), |(sum, squares), p| {
            let w = self.weight(p);
            (sum + w, squares + w * w)
        });
        if sum > 0.0 { sum * sum / squares } else { 0.0 }
    }

    /// Mean of every quantity.
    pub fn mean(&self) -> Microstructure {
        self.structure(|i| self.expected(|p| p.structure[i]))
    }

    /// Standard deviation of every quantity.
    pub fn stddev(&self) -> Microstructure {
        self.structure(|i| {
            let mean = self.expected(|p| p.structure[i]);
            self.expected(|p| (p.structure[i] - mean).powi(2)).sqrt()
        })
    }

    fn structure(&self, value: impl Fn(usize) -> f64) -> Microstructure {
        self.quantities().into_iter().fold(Microstructure::default(), |all, q| all.with(q, value(q as usize)))
    }

    /// Weight over the largest.
    pub(super) fn weight(&self, point: &Point) -> f64 {
        (point.ln_weight - self.highest).exp()
    }

    pub(super) fn expected(&self, value: impl Fn(&Point) -> f64) -> f64 {
        let (sum, total) = self.points.iter().fold((0.0, 0.0), |(sum, total), p| {
            let w = self.weight(p);
            (sum + w * value(p), total + w)
        });
        sum / total
    }
}

/// The point of these numbers in [0, 1): one chooses the part of the proposal, the next the unknowns, the last what follows.
/// `None` where the posterior is 0.
pub(super) fn point(
    target: &Target<'_>,
    proposal: &Proposal,
    replicate: usize,
    uniform: &[f64],
) -> Option<Point> {
    let x = proposal.point(uniform);
    let at = target.at(&x)?;
    let n = x.len();
    let normal = |i: usize| normal::quantile(uniform[1 + n + i].max(1e-16));
    let following = if target.likelihood.following().is_empty() {
        [0.0; FOLLOWING]
    } else {
        at.follow(Vector2::new(normal(0), normal(1)))
    };
    let ln_weight = at.ln() + target.correction(&following) - proposal.ln(&x);
    let mut structure = [0.0; InferredQuantity::COUNT];
    let values = x.iter().chain(&following);
    let quantities = target.likelihood.unknowns().iter().chain(target.likelihood.following());
    for (quantity, value) in quantities.zip(values) {
        structure[*quantity as usize] = *value;
    }
    ln_weight.is_finite().then_some(Point { replicate, ln_weight, structure, at })
}
