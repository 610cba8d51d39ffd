//! Pressures and rows left out, and contradictions.

use super::component::{Mixture, Solution, normalised};
use crate::normal::{below, chi_square_above};
use crate::random::Random;
use nalgebra::{Cholesky, DMatrix, DVector};

/// A row predicted without its group.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct LeftOut {
    /// ln of the measured over the predicted speed.
    pub residual: f64,
    /// Standard deviation of it.
    pub stddev: f64,
    /// True if the measured speed is within the central 95 % of its prediction.
    pub is_inside: bool,
}

/// Number of simulated data of [`Mixture::contradiction`]: a round of them, the most, and the less probable ones that suffice.
const ROUND: usize = 400;
const MOST: usize = 4000;
const SUFFICE: usize = 12;

/// Weight of a component that counts.
const NEGLIGIBLE: f64 = 1e-5;

impl Mixture<'_> {
    /// Each group of measured rows left out, and predicted by all others: the rows, and the probability of worse ones.
    ///
    /// Without another fit: the inverse of the block of S⁻¹ is the covariance of the prediction, and times the pull its error.
    pub(super) fn leave_out(&self, group: &[usize]) -> (Vec<LeftOut>, f64) {
        let block = |s: &Solution| {
            let part = DMatrix::from_fn(group.len(), group.len(), |a, b| s.inverse[(group[a], group[b])]);
            let pull = DVector::from_fn(group.len(), |a, _| s.pull[group[a]]);
            let cholesky = Cholesky::new(part)?;
            let covariance = cholesky.inverse();
            let error = &covariance * &pull;
            let chi_square = error.dot(&pull);
            // Evidence of the others alone.
            let ln_det = -2.0 * cholesky.l_dirty().diagonal().map(f64::ln).sum();
            let variances = covariance.diagonal();
            Some((error, variances, chi_square, s.ln_weight() + 0.5 * (chi_square + ln_det)))
        };
        let all: Vec<_> = self.solutions.iter().filter_map(block).collect();
        let weights = normalised(all.iter().map(|(.., ln)| *ln));
        let mixed =
            |of: &dyn Fn(usize) -> f64| weights.iter().enumerate().map(|(g, w)| w * of(g)).sum::<f64>();
        let p = mixed(&|g| chi_square_above(all[g].2, group.len()));
        let rows = (0..group.len()).map(|a| {
            let residual = mixed(&|g| all[g].0[a]);
            let square = mixed(&|g| all[g].1[a] + all[g].0[a].powi(2));
            // Probability of a smaller speed than the measured one.
            let lower = mixed(&|g| below(all[g].0[a] / all[g].1[a].sqrt()));
            LeftOut {
                residual,
                stddev: (square - residual * residual).max(0.0).sqrt(),
                is_inside: (0.025..=0.975).contains(&lower),
            }
        });
        (rows.collect(), p)
    }

    /// Probability of data that are less probable than these, under all that was assumed before them.
    pub(super) fn contradiction(&self, seed: u64) -> f64 {
        let prior = normalised(self.solutions.iter().map(|s| s.component.ln_prior));
        let highest = prior.iter().copied().fold(0.0, f64::max);
        let mut all = Vec::new();
        for (s, w) in self.solutions.iter().zip(&prior).filter(|(_, w)| **w > NEGLIGIBLE * highest) {
            let Some(factor) = Cholesky::new(s.inverse.clone()).map(Cholesky::unpack) else { continue };
            let ln_det: f64 = factor.diagonal().map(f64::ln).sum();
            all.push((factor.transpose(), &s.residual, *w, w.ln() + ln_det));
        }
        // A datum less the measured one.
        let density = |off: &DVector<f64>| {
            let of = |(whitened, r, _, ln): &(DMatrix<f64>, &DVector<f64>, f64, f64)| {
                ln - 0.5 * (whitened * (off + *r)).norm_squared()
            };
            let ln: Vec<f64> = all.iter().map(of).collect();
            let top = ln.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            top + ln.iter().map(|l| (l - top).exp()).sum::<f64>().ln()
        };
        let here = density(&DVector::zeros(self.forward.measured));
        let mut random = Random::new(seed);
        let total: f64 = all.iter().map(|(_, _, w, _)| w).sum();
        let mut worse = 0;
        let mut simulated = 0;
        while simulated < MOST && (simulated % ROUND > 0 || worse < SUFFICE) {
            simulated += 1;
            let mut left = random.uniform() * total;
            let chosen = all.iter().position(|(_, _, w, _)| {
                left -= w;
                left <= 0.0
            });
            let Some((whitened, r, ..)) = chosen.map(|g| &all[g]) else { continue };
            let draw = DVector::from_fn(r.len(), |_, _| random.normal::<1>()[0]);
            let Some(off) = whitened.solve_upper_triangular(&draw) else { continue };
            worse += usize::from(density(&(off - *r)) <= here);
        }
        // These data are one of them.
        (worse + 1) as f64 / (simulated + 1) as f64
    }
}
