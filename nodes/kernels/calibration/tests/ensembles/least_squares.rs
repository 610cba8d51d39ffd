//! Ordinary least squares over packings, several states of each.

use nalgebra::{DMatrix, DVector};
use std::collections::BTreeSet;

/// Row of a regression: a number, the numbers that it may follow from, and the packing and recipe that it belongs to.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    pub(crate) value: f64,
    pub(crate) causes: Vec<f64>,
    pub(crate) packing: String,
    pub(crate) recipe: String,
}

/// Coefficients of the causes, their standard errors, and how well they predict.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    pub(crate) coefficients: Vec<f64>,
    /// By the jackknife over packings: states of one packing are not independent.
    pub(crate) errors: Vec<f64>,
    /// Coefficients with each packing left out.
    pub(crate) without: Vec<Vec<f64>>,
    /// Share of the variance that the causes explain.
    pub(crate) r2: f64,
    /// Root mean square error of recipes that the fit left out.
    pub(crate) left_out: f64,
}

impl Fit {
    /// Fit of a linear law with a constant.
    pub(crate) fn of(points: &[Point]) -> Self {
        let all = law(points);
        let names = |of: fn(&Point) -> &String| points.iter().map(of).collect::<BTreeSet<_>>();
        let rest =
            |keep: &dyn Fn(&Point) -> bool| points.iter().filter(|p| keep(p)).cloned().collect::<Vec<_>>();
        let packings = names(|p| &p.packing);
        let without: Vec<Vec<f64>> =
            packings.iter().map(|name| law(&rest(&|p| p.packing != **name))[1..].to_vec()).collect();
        let squares = names(|p| &p.recipe).into_iter().map(|recipe| {
            let others = law(&rest(&|p| p.recipe != *recipe));
            let own = rest(&|p| p.recipe == *recipe);
            own.iter().map(|p| residual(&others, p).powi(2)).sum::<f64>()
        });
        let mean = points.iter().map(|p| p.value).sum::<f64>() / points.len() as f64;
        let total: f64 = points.iter().map(|p| (p.value - mean).powi(2)).sum();
        let left: f64 = points.iter().map(|p| residual(&all, p).powi(2)).sum();
        let left_out = (squares.sum::<f64>() / points.len() as f64).sqrt();
        let coefficients = all[1..].to_vec();
        let errors = (0..coefficients.len()).map(|i| jackknife(without.iter().map(|c| c[i]))).collect();
        Self { coefficients, errors, without, r2: 1.0 - left / total, left_out }
    }

    /// A function of the coefficients of two fits to the same packings, with its standard error.
    pub(crate) fn compared(&self, other: &Fit, of: impl Fn(&[f64], &[f64]) -> f64) -> [f64; 2] {
        let parts = self.without.iter().zip(&other.without).map(|(a, b)| of(a, b));
        [of(&self.coefficients, &other.coefficients), jackknife(parts)]
    }
}

/// Rows with the mean of their packing taken off every number: only what changes within a packing is left.
pub(crate) fn within_packings(points: &[Point]) -> Vec<Point> {
    let of_packing = |p: &Point| points.iter().filter(|o| o.packing == p.packing).collect::<Vec<_>>();
    let off = |p: &Point| {
        let own = of_packing(p);
        let mean = |of: &dyn Fn(&Point) -> f64| own.iter().map(|o| of(o)).sum::<f64>() / own.len() as f64;
        let causes = (0..p.causes.len()).map(|i| p.causes[i] - mean(&|o| o.causes[i])).collect();
        Point { value: p.value - mean(&|o| o.value), causes, ..p.clone() }
    };
    points.iter().map(off).collect()
}

/// The constant, then the coefficients.
fn law(points: &[Point]) -> Vec<f64> {
    let design = DMatrix::from_fn(points.len(), 1 + points[0].causes.len(), |i, j| {
        if j == 0 { 1.0 } else { points[i].causes[j - 1] }
    });
    let values = DVector::from_iterator(points.len(), points.iter().map(|p| p.value));
    // The smallest solution, where one cause is the same in all points.
    let found = design.svd(true, true).solve(&values, 1e-12).unwrap();
    found.iter().copied().collect()
}

fn residual(law: &[f64], point: &Point) -> f64 {
    point.value - law[0] - law[1..].iter().zip(&point.causes).map(|(c, x)| c * x).sum::<f64>()
}

fn jackknife(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    ((n - 1.0) / n * values.iter().map(|v| (v - mean).powi(2)).sum::<f64>()).sqrt()
}

#[test]
fn a_known_law_comes_back_with_the_error_of_its_noise() {
    // y = 7 + 2 x1 − 3 x2 and an alternating error of 0.1, which no cause follows.
    let noise = |i: i32| if (i / 2) % 2 == 0 { 0.1 } else { -0.1 };
    let point = |i: i32| {
        let (x1, x2) = (f64::from(i % 5), f64::from((i / 5) % 3));
        let causes = vec![x1, x2];
        let value = 7.0 + 2.0 * x1 - 3.0 * x2 + noise(i);
        Point { value, causes, packing: i.to_string(), recipe: (i / 20).to_string() }
    };
    let points: Vec<Point> = (0..60).map(point).collect();
    let fit = Fit::of(&points);
    let textbook = 0.1 / (60.0f64 * 2.0).sqrt();
    assert!((fit.coefficients[0] - 2.0).abs() < 3.0 * textbook && (fit.coefficients[1] + 3.0).abs() < 0.05);
    assert!((fit.errors[0] / textbook - 1.0).abs() < 0.15, "{} {textbook}", fit.errors[0]);
    assert!(fit.r2 > 0.998 && (fit.left_out - 0.1).abs() < 0.02, "{} {}", fit.r2, fit.left_out);
}

/// Packings that differ by more than what changes within them, against the law within.
#[test]
fn what_differs_between_packings_is_left_out_within_them() {
    let point = |i: i32| {
        let (packing, state) = (i / 4, f64::from(i % 4));
        let cause = f64::from(packing) + state;
        let value = 5.0 * state - 9.0 * f64::from(packing);
        Point { value, causes: vec![cause], packing: packing.to_string(), recipe: packing.to_string() }
    };
    let points: Vec<Point> = (0..24).map(point).collect();
    let [across, within] = [&points, &within_packings(&points)].map(|p| Fit::of(p).coefficients[0]);
    assert!(across < 0.0 && (within - 5.0).abs() < 1e-12, "{across} {within}");
}
