//! A normal distribution multiplied by priors of its components, as a normal distribution with the same means and covariances.
//!
//! For normal priors this is exact, and for one prior with limits the moments are. For several with limits it is expectation
//! propagation (Minka 2001): each prior is replaced by the normal density with which the product of all has the moments that
//! it has with the prior itself.

use crate::prior::{Density, Prior};
use grainlab_core::results::{InferredQuantity, MicrostructureCovariance};
use nalgebra::{DMatrix, DVector, SVector};

/// Maximum number of passes; with one prior, or normal ones alone, two suffice.
const PASSES: usize = 200;

/// Relative change of the moments at which the passes end.
const SETTLED: f64 = 1e-12;

type Vector = SVector<f64, { InferredQuantity::COUNT }>;

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Updated {
    /// Change of the means.
    pub(crate) shift: Vector,
    pub(crate) covariance: MicrostructureCovariance,
    /// Derivative of the means with respect to those before.
    pub(crate) kept: MicrostructureCovariance,
}

/// A prior as the normal density exp(−τ x²/2 + ν x), with x from the mean of its component before.
struct Site {
    at: usize,
    density: Density,
    origin: f64,
    precision: f64,
    linear: f64,
}

/// The distribution of these means and this covariance, multiplied by the priors of the components with a variance.
pub(crate) fn updated(mean: &Vector, covariance: &MicrostructureCovariance, prior: &Prior) -> Updated {
    let site = |quantity: InferredQuantity| {
        let (at, density) = (quantity as usize, *prior.get(quantity)?);
        (covariance[(at, at)] > 0.0).then_some(Site {
            at,
            density,
            origin: mean[at],
            precision: 0.0,
            linear: 0.0,
        })
    };
    let mut sites: Vec<Site> = InferredQuantity::ALL.into_iter().filter_map(site).collect();
    let mut now = with_sites(covariance, &sites);
    for _ in 0..PASSES {
        let before = now.clone();
        for i in 0..sites.len() {
            sites[i].refine(&now);
            now = with_sites(covariance, &sites);
        }
        let settled = sites.iter().all(|s| {
            let (variance, last) = (now.covariance[(s.at, s.at)], before.covariance[(s.at, s.at)]);
            (variance - last).abs() <= SETTLED * last
                && (now.shift[s.at] - before.shift[s.at]).abs() <= SETTLED * last.sqrt()
        });
        if settled {
            break;
        }
    }
    now
}

impl Site {
    /// Matches the moments that the prior itself gives.
    fn refine(&mut self, now: &Updated) {
        let (variance, shift) = (now.covariance[(self.at, self.at)], now.shift[self.at]);
        // Without this site.
        let precision = 1.0 / variance - self.precision;
        if !(precision > 0.0 && precision.is_finite()) {
            return;
        }
        let linear = shift / variance - self.linear;
        let tilted = self.density.tilted(self.origin + linear / precision, 1.0 / precision);
        let (own, at) = (1.0 / tilted.variance - precision, tilted.mean - self.origin);
        if own.is_finite() && at.is_finite() {
            // Log-concave priors never widen: below 0 it is rounding.
            self.precision = own.max(0.0);
            self.linear = at * (precision + self.precision) - linear;
        }
    }
}

/// The distribution with the sites as they are, in a form that takes any covariance, also a singular one.
fn with_sites(covariance: &MicrostructureCovariance, sites: &[Site]) -> Updated {
    let n = sites.len();
    let root = DVector::from_iterator(n, sites.iter().map(|s| s.precision.sqrt()));
    let b = DMatrix::from_fn(n, n, |i, j| {
        f64::from(u8::from(i == j)) + root[i] * covariance[(sites[i].at, sites[j].at)] * root[j]
    });
    let columns = DMatrix::from_fn(InferredQuantity::COUNT, n, |i, j| covariance[(i, sites[j].at)] * root[j]);
    let mut with = *covariance;
    if let Some(solved) = b.cholesky().map(|c| c.solve(&columns.transpose())) {
        let less = &columns * &solved;
        with -= MicrostructureCovariance::from_fn(|i, j| less[(i, j)]);
        // Without a difference: where a prior is narrow that is rounding alone.
        for (j, site) in
            sites.iter().enumerate().filter(|(_, s)| s.precision * covariance[(s.at, s.at)] > 1.0)
        {
            for i in 0..InferredQuantity::COUNT {
                let exact = solved[(j, i)] / root[j];
                (with[(i, site.at)], with[(site.at, i)]) = (exact, exact);
            }
        }
    }
    let (mut shift, mut kept) = (Vector::zeros(), MicrostructureCovariance::identity());
    for site in sites {
        let column = with.column(site.at).into_owned();
        shift += column * site.linear;
        kept.column_mut(site.at).axpy(-site.precision, &column, 1.0);
    }
    Updated { shift, covariance: with, kept }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn before() -> (Vector, MicrostructureCovariance) {
        let mut covariance = MicrostructureCovariance::zeros();
        let rows = [[0.04, 0.03, 0.001], [0.03, 0.05, -0.002], [0.001, -0.002, 0.0009]];
        let order = [InferredQuantity::K, InferredQuantity::Z, InferredQuantity::Eps];
        for (a, row) in order.iter().zip(rows) {
            for (b, value) in order.iter().zip(row) {
                covariance[(*a as usize, *b as usize)] = value;
            }
        }
        (Vector::from([4.5, 0.0, 4.9, 0.03, 0.0]), covariance)
    }

    /// Conditional distribution of a normal one.
    #[test]
    fn a_narrow_prior_fixes_its_quantity_and_the_others_follow_by_regression() {
        let (mean, covariance) = before();
        let prior = Prior::default().with(InferredQuantity::Z, Density::normal(5.1, 1e-9).unwrap());
        let found = updated(&mean, &covariance, &prior);
        assert!((found.shift[2] - 0.2).abs() < 1e-12 && found.covariance[(2, 2)].sqrt() < 1.001e-9);
        assert!((found.shift[0] - 0.03 / 0.05 * 0.2).abs() < 1e-12);
        assert!((found.covariance[(0, 0)] - (0.04 - 0.03 * 0.03 / 0.05)).abs() < 1e-12);
    }

    #[test]
    fn wide_priors_change_nothing() {
        let (mean, covariance) = before();
        let wide = Density::uniform(-10.0, 20.0).unwrap();
        let prior = Prior::default().with(InferredQuantity::Z, wide).with(InferredQuantity::Eps, wide);
        let found = updated(&mean, &covariance, &prior);
        assert!(found.shift.amax() < 1e-12, "{}", found.shift);
        assert!((found.covariance - covariance).amax() < 1e-13);
    }

    /// Moments by a sum over a grid of two dimensions.
    #[test]
    fn limits_of_two_quantities_give_the_moments_of_the_limited_distribution() {
        let (mean, covariance) = before();
        let (z, eps) = ([4.9, 5.3], [-0.01, 0.04]);
        let prior = Prior::default()
            .with(InferredQuantity::Z, Density::uniform(z[0], z[1]).unwrap())
            .with(InferredQuantity::Eps, Density::uniform(eps[0], eps[1]).unwrap());
        let found = updated(&mean, &covariance, &prior);
        let part = nalgebra::Matrix2::new(0.05, -0.002, -0.002, 0.0009).try_inverse().unwrap();
        let (mut total, mut sums) = (0.0, [0.0; 4]);
        let n = 400;
        for i in 0..n {
            for j in 0..n {
                let at = |[low, high]: [f64; 2], i: usize| {
                    low + (high - low) * (i as f64 + 0.5) / f64::from(n as u32)
                };
                let x = nalgebra::Vector2::new(at(z, i) - mean[2], at(eps, j) - mean[3]);
                let w = (-0.5 * x.dot(&(part * x))).exp();
                total += w;
                for (sum, v) in sums.iter_mut().zip([x[0], x[1], x[0] * x[0], x[1] * x[1]]) {
                    *sum += w * v;
                }
            }
        }
        let [mz, me, zz, ee] = sums.map(|s| s / total);
        let (sz, se) = ((zz - mz * mz).sqrt(), (ee - me * me).sqrt());
        assert!((found.shift[2] - mz).abs() < 0.01 * sz && (found.shift[3] - me).abs() < 0.01 * se);
        assert!((found.covariance[(2, 2)].sqrt() / sz - 1.0).abs() < 0.01);
        assert!((found.covariance[(3, 3)].sqrt() / se - 1.0).abs() < 0.01);
    }
}
