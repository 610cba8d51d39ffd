//! A normal approximation of the posterior for one cell of the prior: a contact law, a preparation, and cells of k_t/k_n, the
//! crossover and the noise.

use super::forward::{Forward, Linearised};
use super::gain::ContactKind;
use super::prior::SeriesPrior;
use crate::normal::LN_SQRT_TAU;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::sync::Arc;

/// Most steps of an iteration, and the change of u below which it has settled.
const STEPS: usize = 5;
const SETTLED: f64 = 0.1;

/// Largest change of u in a step.
const LARGEST_STEP: f64 = 1.0;

/// One cell, and the posterior of its unknowns.
#[derive(Clone)]
pub(super) struct Component {
    pub(super) kind: ContactKind,
    /// Place of the preparation.
    pub(super) preparation: usize,
    /// Factor of the stated errors.
    pub(super) noise: f64,
    pub(super) ln_prior: f64,
    /// Prior of the unknowns: mean, covariance, and its Cholesky factor.
    pub(super) normal: Arc<(DVector<f64>, DMatrix<f64>, DMatrix<f64>)>,
    /// Mean of the posterior.
    pub(super) unknowns: DVector<f64>,
}

/// The linear problem of a component.
pub(super) struct Solution {
    pub(super) component: Component,
    pub(super) at: Linearised,
    /// Data less their predicted mean.
    pub(super) residual: DVector<f64>,
    /// Inverse of the covariance of the data, S⁻¹, and S⁻¹ times the residual.
    pub(super) inverse: DMatrix<f64>,
    pub(super) pull: DVector<f64>,
    /// Covariance of the prior times the transposed slopes.
    pub(super) gain: DMatrix<f64>,
    /// Cholesky factor of what θ does not explain.
    pub(super) unexplained: Cholesky<f64, Dyn>,
    pub(super) ln_evidence: f64,
    /// Largest change of u in the step.
    change: f64,
}

impl Component {
    fn settled(self, forward: &Forward<'_>, data: &DVector<f64>) -> Option<Solution> {
        let mut last = self.step(forward, data)?;
        for _ in 1..STEPS {
            if last.change < SETTLED {
                break;
            }
            last = last.component.step(forward, data)?;
        }
        Some(last)
    }

    /// A Gauss–Newton step, and the linear problem that it solves.
    fn step(self, forward: &Forward<'_>, data: &DVector<f64>) -> Option<Solution> {
        let m = forward.measured;
        let at = forward.about(self.kind, self.preparation, &self.unknowns);
        let slopes = at.by_unknowns.rows(0, m);
        let normal = Arc::clone(&self.normal);
        let (mean, covariance, _) = &*normal;
        let gain = covariance * slopes.transpose();
        let own = forward.unexplained(&at, m, self.noise);
        let all = slopes * &gain + &own;
        let cholesky = Cholesky::new(all)?;
        let predicted = at.ln_speed.rows(0, m) + slopes * (mean - &self.unknowns);
        let residual = data - predicted;
        let inverse = cholesky.inverse();
        let pull = &inverse * &residual;
        let ln_det = cholesky.l_dirty().diagonal().map(f64::ln).sum();
        let ln_evidence = -0.5 * residual.dot(&pull) - ln_det - m as f64 * LN_SQRT_TAU;
        let mut component = self;
        let next = mean + &gain * &pull;
        let ratio = forward.ratio();
        let mut largest = 0.0_f64;
        for (k, (now, next)) in component.unknowns.iter_mut().zip(next.iter()).enumerate() {
            let change = next - *now;
            *now += if k < ratio { change.clamp(-LARGEST_STEP, LARGEST_STEP) } else { change };
            largest = if k < ratio { largest.max(change.abs()) } else { largest };
        }
        Some(Solution {
            component,
            at,
            residual,
            inverse,
            pull,
            gain,
            unexplained: Cholesky::new(own)?,
            ln_evidence,
            change: largest,
        })
    }
}

impl Solution {
    /// Variances of the unknowns.
    pub(super) fn variances(&self) -> DVector<f64> {
        let (_, covariance, _) = &*self.component.normal;
        let explained = &self.gain * &self.inverse;
        DVector::from_fn(covariance.nrows(), |k, _| {
            (covariance[(k, k)] - explained.row(k).dot(&self.gain.row(k))).max(1e-12)
        })
    }

    /// ln of prior and evidence.
    pub(super) fn ln_weight(&self) -> f64 {
        self.component.ln_prior + self.ln_evidence
    }
}

pub(super) struct Mixture<'a> {
    pub(super) forward: Forward<'a>,
    pub(super) data: DVector<f64>,
    pub(super) solutions: Vec<Solution>,
    /// Posterior probabilities of the components.
    pub(super) weights: Vec<f64>,
}

impl<'a> Mixture<'a> {
    /// Every cell of the prior, each to convergence; empty if the data have no room in the model.
    pub(super) fn of(forward: Forward<'a>, ln_crossover: Option<[f64; 2]>) -> Self {
        let data = forward.data();
        let prior = forward.prior;
        let noises = prior.noises();
        let mut solutions = Vec::new();
        for mut component in cells(&forward, prior, ln_crossover) {
            component.noise = (prior.noise[0] * prior.noise[1]).sqrt();
            let Some(start) = component.settled(&forward, &data) else { continue };
            for [noise, weight] in noises {
                let ln_prior = start.component.ln_prior + weight.ln();
                let from = Component { noise, ln_prior, ..start.component.clone() };
                solutions.extend(from.settled(&forward, &data));
            }
        }
        let weights = normalised(solutions.iter().map(Solution::ln_weight));
        Self { forward, data, solutions, weights }
    }

    pub(super) fn ln_evidence(&self) -> f64 {
        let highest = self.solutions.iter().map(Solution::ln_weight).fold(f64::NEG_INFINITY, f64::max);
        highest + self.solutions.iter().map(|s| (s.ln_weight() - highest).exp()).sum::<f64>().ln()
    }
}

/// Probabilities from their logarithms.
pub(super) fn normalised(ln: impl Iterator<Item = f64> + Clone) -> Vec<f64> {
    let highest = ln.clone().fold(f64::NEG_INFINITY, f64::max);
    let all: Vec<f64> = ln.map(|w| (w - highest).exp()).collect();
    let sum: f64 = all.iter().sum();
    all.into_iter().map(|w| w / sum).collect()
}

pub(super) fn cells(forward: &Forward<'_>, prior: &SeriesPrior, known: Option<[f64; 2]>) -> Vec<Component> {
    let mut all = Vec::new();
    let ratio = forward.ratio();
    let bases: Vec<_> = prior.preparation.iter().map(|p| forward.of_preparation(p)).collect();
    for contact in &prior.contact {
        for cross in SeriesPrior::crossovers(contact, known) {
            for cell in prior.stiffness_ratios(forward.mindlin) {
                for (preparation, (of, base)) in prior.preparation.iter().zip(&bases).enumerate() {
                    let (mut mean, mut covariance) = base.clone();
                    (mean[ratio], mean[ratio + 1]) = (cell.mean, cross.mean);
                    covariance[(ratio, ratio)] = cell.stddev.powi(2);
                    covariance[(ratio + 1, ratio + 1)] = cross.stddev.powi(2);
                    let weight = contact.weight * cross.weight * cell.weight * of.weight;
                    let Some(factor) = Cholesky::new(covariance.clone()) else { continue };
                    all.push(Component {
                        kind: contact.law,
                        preparation,
                        noise: 1.0,
                        ln_prior: weight.ln(),
                        unknowns: mean.clone(),
                        normal: Arc::new((mean, covariance, factor.unpack())),
                    });
                }
            }
        }
    }
    let probabilities = normalised(all.iter().map(|c| c.ln_prior));
    all.iter_mut().zip(probabilities).for_each(|(c, p)| c.ln_prior = p.ln());
    all
}
