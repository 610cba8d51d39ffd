//! Weighted linear least squares, and minimisation in one variable.

use grainlab_emt::CalibrationError;
use nalgebra::{DMatrix, DVector};

/// Coefficients, and the inverse of the normal matrix.
pub(crate) struct Regression {
    pub(crate) coefficients: Vec<f64>,
    pub(crate) inverse: DMatrix<f64>,
    /// Weighted sum of squared residuals.
    pub(crate) squares: f64,
}

/// Fits y by linear combinations of the columns of x. Each row is (x, y, weight of the residual).
pub(crate) fn linear<const N: usize>(
    rows: &[([f64; N], f64, f64)],
    what: &'static str,
) -> Result<Regression, CalibrationError> {
    let too_few = CalibrationError::Packings { what, found: rows.len(), needed: N + 1 };
    if rows.len() <= N {
        return Err(too_few);
    }
    let x = DMatrix::from_fn(rows.len(), N, |i, j| rows[i].0[j] * rows[i].2);
    let y = DVector::from_fn(rows.len(), |i, _| rows[i].1 * rows[i].2);
    // Columns are scaled to norm 1, so that the threshold for a singular matrix has no unit.
    let scale: Vec<f64> = x.column_iter().map(|c| c.norm().max(f64::MIN_POSITIVE)).collect();
    let scaled = DMatrix::from_fn(rows.len(), N, |i, j| x[(i, j)] / scale[j]);
    let normal = scaled.transpose() * &scaled;
    let determined = normal.clone().symmetric_eigenvalues().min() > 1e-12;
    let inverse = normal.try_inverse().filter(|_| determined).ok_or(too_few)?;
    let solution = &inverse * (scaled.transpose() * &y);
    let squares = (&scaled * &solution - y).norm_squared();
    let coefficients = solution.iter().zip(&scale).map(|(c, s)| c / s).collect();
    let inverse = DMatrix::from_fn(N, N, |i, j| inverse[(i, j)] / scale[i] / scale[j]);
    Ok(Regression { coefficients, inverse, squares })
}

/// Coefficients of all columns, 0 for those that the rows do not determine, and the weighted sum of squared residuals.
pub(crate) struct Determined<const N: usize> {
    pub(crate) coefficients: [f64; N],
    pub(crate) squares: f64,
}

/// Share of a column that the columns before it must leave unexplained for its coefficient to be determined.
const INDEPENDENT: f64 = 1e-5;

/// As [`linear`], but a column that is zero or a combination of those before it gets the coefficient 0: packings of one
/// material do not determine how the material acts. The rows are of this many independent packings.
pub(crate) fn determined<const N: usize>(
    rows: &[([f64; N], f64, f64)],
    packings: usize,
    what: &'static str,
) -> Result<Determined<N>, CalibrationError> {
    let column = |j: usize| DVector::from_fn(rows.len(), |i, _| rows[i].0[j] * rows[i].2);
    let mut basis: Vec<DVector<f64>> = Vec::with_capacity(N);
    let mut kept = Vec::with_capacity(N);
    for j in 0..N {
        let whole = column(j);
        let norm = whole.norm();
        let mut rest = whole;
        // Twice, against rounding.
        for _ in 0..2 {
            for b in &basis {
                let along = b.dot(&rest);
                rest.axpy(-along, b, 1.0);
            }
        }
        if rest.norm() > INDEPENDENT * norm {
            basis.push(rest.normalize());
            kept.push(j);
        }
    }
    let n = kept.len();
    if packings <= n || n == 0 {
        return Err(CalibrationError::Packings { what, found: packings, needed: n + 1 });
    }
    let y = DVector::from_fn(rows.len(), |i, _| rows[i].1 * rows[i].2);
    let q = DMatrix::from_columns(&basis);
    let x = DMatrix::from_columns(&kept.iter().map(|j| column(*j)).collect::<Vec<_>>());
    // x = q r with r upper triangular.
    let (projected, r) = (q.transpose() * &y, q.transpose() * &x);
    let singular = CalibrationError::Packings { what, found: packings, needed: n + 1 };
    let solution = r.solve_upper_triangular(&projected).ok_or(singular)?;
    let mut coefficients = [0.0; N];
    kept.iter().zip(solution.iter()).for_each(|(j, value)| coefficients[*j] = *value);
    Ok(Determined { coefficients, squares: (x * solution - y).norm_squared() })
}

/// The minimum of `f` in [low, high], if it is the only one there, by golden-section search.
pub(crate) fn minimum(mut low: f64, mut high: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_a, mut at_b) = (f(a), f(b));
    while high - low > 1e-7 {
        if at_a < at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - golden * (high - low);
            at_a = f(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + golden * (high - low);
            at_b = f(b);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_recovered_from_its_points_and_too_few_points_are_an_error() {
        let points: Vec<_> = (0..5).map(|i| ([1.0, f64::from(i)], 2.0 - 0.5 * f64::from(i), 1.0)).collect();
        let fit = linear(&points, "points").unwrap();
        assert!((fit.coefficients[0] - 2.0).abs() < 1e-12 && (fit.coefficients[1] + 0.5).abs() < 1e-12);
        assert!(fit.squares < 1e-24);
        assert!(linear(&points[..2], "points").is_err());
        let same: Vec<_> = (0..5).map(|_| ([1.0, 3.0], 1.0, 1.0)).collect();
        assert!(matches!(linear(&same, "points"), Err(CalibrationError::Packings { .. })));
    }

    #[test]
    fn columns_that_the_points_do_not_determine_get_no_coefficient() {
        let points: Vec<_> =
            (0..6).map(|i| ([1.0, 3.0, f64::from(i), 0.0], 2.0 - 0.5 * f64::from(i), 1.0)).collect();
        let fit = determined(&points, 6, "points").unwrap();
        let [level, same, slope, zero] = fit.coefficients;
        assert!((level - 2.0).abs() < 1e-12 && (slope + 0.5).abs() < 1e-12 && fit.squares < 1e-24);
        assert_eq!((same, zero), (0.0, 0.0));
        assert!(determined(&points, 2, "points").is_err(), "two coefficients from two packings");
    }

    #[test]
    fn the_minimum_of_a_parabola_is_found() {
        assert!((minimum(0.0, 10.0, |x| (x - 3.7f64).powi(2)) - 3.7).abs() < 1e-6);
    }
}
