//! The distribution from which points are proposed: a mixture of two normal ones about the posterior.

use super::target::{Target, TargetValue};
use crate::error::EmtError;
use crate::normal::{self, LN_SQRT_TAU};
use nalgebra::{DMatrix, DVector};

/// Standard deviations of the two parts over that of the posterior, and the share of the second. The wide part bounds the
/// weights where the posterior has heavier tails than a normal distribution.
const SCALES: [f64; 2] = [1.15, 3.0];
const WIDE: f64 = 0.15;

/// Passes of the search for mean and covariance, each on a grid about the result of the pass before.
const PASSES: usize = 12;

/// Half width of the grid in standard deviations.
const REACH: f64 = 5.0;

/// A mixture of two normal distributions.
pub(super) struct Proposal {
    mean: DVector<f64>,
    /// Lower triangular root of the covariance.
    root: DMatrix<f64>,
    ln_det: f64,
}

impl Proposal {
    /// About the density with this logarithm, found on grids over the range of the priors.
    pub(super) fn about(target: &Target<'_>, ln: impl Fn(&TargetValue) -> f64) -> Result<Self, EmtError> {
        let n = target.unknowns.len();
        let nodes: usize = [65, 65, 25, 13][n.min(3)];
        let whole: Vec<[f64; 2]> = target.unknowns.iter().map(|d| d.effective_range()).collect();
        let mut range = whole.clone();
        let mut found = None;
        for _ in 0..PASSES {
            let Some((mean, covariance)) = moments(target, &ln, &range, nodes) else { break };
            let next: Vec<[f64; 2]> = (0..n)
                .map(|i| {
                    let half = REACH * covariance[(i, i)].sqrt();
                    [whole[i][0].max(mean[i] - half), whole[i][1].min(mean[i] + half)]
                })
                .collect();
            let is_near = |(a, b): (&[f64; 2], &[f64; 2])| {
                let width = b[1] - b[0];
                (a[0] - b[0]).abs() < 0.1 * width && (a[1] - b[1]).abs() < 0.1 * width
            };
            let settled = range.iter().zip(&next).all(is_near);
            found = Some((mean, covariance));
            range = next;
            if settled {
                break;
            }
        }
        let none = EmtError::NotSampled {
            model: target.model,
            reason: "it is 0 wherever the prior is not; compare the prior with the estimate without one",
        };
        let (mean, covariance) = found.ok_or(none.clone())?;
        let root = covariance.cholesky().ok_or(none)?.l();
        let ln_det = root.diagonal().map(f64::ln).sum();
        Ok(Self { mean, root, ln_det })
    }

    /// The point of these numbers in [0, 1): one chooses the part, the others the place.
    pub(super) fn point(&self, uniform: &[f64]) -> Vec<f64> {
        let n = self.mean.len();
        let scale = SCALES[usize::from(uniform[0] < WIDE)];
        // Not 0, where the quantile is infinite.
        let normal = DVector::from_iterator(n, uniform[1..=n].iter().map(|u| normal::quantile(u.max(1e-16))));
        (&self.mean + &self.root * normal * scale).as_slice().to_vec()
    }

    /// ln of the density of the proposal at a point.
    pub(super) fn ln(&self, x: &[f64]) -> f64 {
        let n = self.mean.len() as f64;
        let off = DVector::from_row_slice(x) - &self.mean;
        let square = self.root.solve_lower_triangular(&off).map_or(f64::INFINITY, |v| v.norm_squared());
        let part = |scale: f64| (-0.5 * square / (scale * scale)).exp() / scale.powf(n);
        let density = (1.0 - WIDE) * part(SCALES[0]) + WIDE * part(SCALES[1]);
        density.ln() - self.ln_det - n * LN_SQRT_TAU
    }
}

/// Mean and covariance of the density over the cells of a grid; `None` where it is 0 in all of them.
fn moments(
    target: &Target<'_>,
    ln: &impl Fn(&TargetValue) -> f64,
    range: &[[f64; 2]],
    nodes: usize,
) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let n = range.len();
    let cell = DVector::from_iterator(n, range.iter().map(|[low, high]| (high - low) / nodes as f64));
    let point = |mut index: usize| {
        DVector::from_fn(n, |i, _| {
            let at = index % nodes;
            index /= nodes;
            range[i][0] + (at as f64 + 0.5) * cell[i]
        })
    };
    let of = |index: usize| {
        let x = point(index);
        let value = ln(&target.at(x.as_slice())?);
        Some((x, value))
    };
    let all: Vec<_> = (0..nodes.pow(n as u32)).filter_map(of).collect();
    let highest = all.iter().map(|(_, ln)| *ln).reduce(f64::max)?;
    let weighted: Vec<_> = all.into_iter().map(|(x, ln)| (x, (ln - highest).exp())).collect();
    let total: f64 = weighted.iter().map(|(_, w)| w).sum();
    let mean = weighted.iter().fold(DVector::zeros(n), |sum, (x, w)| sum + x * (w / total));
    // The extent of the cells themselves is part of it.
    let own = DMatrix::from_diagonal(&cell.map(|c| c * c / 12.0));
    let covariance = weighted.iter().fold(own, |sum, (x, w)| {
        let off = x - &mean;
        sum + &off * off.transpose() * (w / total)
    });
    Some((mean, covariance))
}
