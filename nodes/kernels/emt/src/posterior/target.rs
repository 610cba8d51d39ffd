//! Likelihood times prior.

use crate::error::EmtError;
use crate::likelihood::{FOLLOWING, Likelihood, Predicted};
use crate::normal;
use crate::prior::{Density, Prior};
use grainlab_core::results::InferredQuantity;
use nalgebra::{Cholesky, Matrix2, Vector2};

/// The unnormalised posterior of the unknowns, and of what follows from them.
pub(super) struct Target<'a> {
    pub(super) model: &'static str,
    pub(super) likelihood: Box<dyn Likelihood + 'a>,
    /// Priors of the unknowns.
    pub(super) unknowns: Vec<Density>,
    /// Priors of what follows.
    pub(super) following: [Option<Density>; FOLLOWING],
    /// Moments of these quantities.
    moments: [Option<[f64; 2]>; FOLLOWING],
}

pub(super) struct TargetValue {
    pub(super) predicted: Predicted,
    pub(super) ln_likelihood: f64,
    /// ln prior of the unknowns.
    pub(super) ln_prior: f64,
    /// ln of the factor by which the priors of what follows, as normal densities, change the posterior.
    ln_overlap: f64,
    /// Mean and root of the covariance of what follows, with these normal densities.
    mean: Vector2<f64>,
    root: Matrix2<f64>,
}

impl TargetValue {
    /// ln of likelihood and prior, what follows integrated out.
    pub(super) fn ln(&self) -> f64 {
        self.ln_likelihood + self.ln_prior + self.ln_overlap
    }

    /// Draw of what follows, from two independent normal numbers.
    pub(super) fn follow(&self, normal: Vector2<f64>) -> [f64; FOLLOWING] {
        (self.mean + self.root * normal).into()
    }
}

impl<'a> Target<'a> {
    /// The prior is completed for the model.
    pub(super) fn new(
        model: &'static str,
        likelihood: Box<dyn Likelihood + 'a>,
        prior: &Prior,
    ) -> Result<Self, EmtError> {
        let of = |q: &InferredQuantity| {
            prior.get(*q).copied().ok_or(EmtError::Missing { model, missing: "a prior of each unknown" })
        };
        let unknowns = likelihood.unknowns().iter().map(of).collect::<Result<Vec<_>, _>>()?;
        let names = likelihood.following();
        let following: [Option<Density>; FOLLOWING] =
            std::array::from_fn(|i| names.get(i).and_then(|q| prior.get(*q)).copied());
        let moments = following.map(|density| density.map(|d| d.moments()));
        Ok(Self { model, likelihood, unknowns, following, moments })
    }

    /// `None` where the posterior is 0.
    pub(super) fn at(&self, x: &[f64]) -> Option<TargetValue> {
        let ln_prior: f64 = self.unknowns.iter().zip(x).map(|(density, x)| density.ln(*x)).sum();
        if ln_prior == f64::NEG_INFINITY {
            return None;
        }
        let predicted = self.likelihood.at(x)?;
        let ln_likelihood = predicted.ln();
        let (mut mean, mut covariance) = predicted.following;
        let mut ln_overlap = 0.0;
        for (i, moments) in self.moments.iter().enumerate() {
            let Some([at, variance]) = *moments else { continue };
            let total = covariance[(i, i)] + variance;
            ln_overlap += normal::ln_density(at, mean[i], total.sqrt());
            let gain = covariance.column(i) / total;
            mean += gain * (at - mean[i]);
            covariance -= gain * covariance.row(i).into_owned();
        }
        let root = if self.likelihood.following().is_empty() {
            Matrix2::zeros()
        } else {
            Cholesky::new(0.5 * (covariance + covariance.transpose()))?.l()
        };
        (ln_likelihood + ln_overlap).is_finite().then_some(TargetValue {
            predicted,
            ln_likelihood,
            ln_prior,
            ln_overlap,
            mean,
            root,
        })
    }

    /// ln of the priors of what follows over the normal densities that stand for them.
    pub(super) fn correction(&self, following: &[f64; FOLLOWING]) -> f64 {
        let one = |i: usize| {
            let (density, [mean, variance]) = (self.following[i]?, self.moments[i]?);
            Some(density.ln(following[i]) - normal::ln_density(following[i], mean, variance.sqrt()))
        };
        (0..FOLLOWING).filter_map(one).sum()
    }
}
