//! A speed at several wavelengths, and its limit for long waves.
//!
//! In a packing of grains of diameter D, waves of wave number q have v² = v₀² (1 − b q² + O(q⁴)). b is of the
//! order of D²/10: D²/12 for a chain, 0.1 D² (S) to 0.2 D² (P) for packings.

use grainlab_core::Vec3;
use nalgebra::{DMatrix, DVector};

/// A speed at one wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DispersionPoint {
    /// Wave number |q|, rad/m.
    pub wavenumber: f64,
    /// Phase speed, m/s.
    pub speed: f64,
    /// Standard deviation of the speed, m/s.
    pub stddev: f64,
}

/// Speeds of one mode, and their limit by v² = v₀² (1 − b q²).
#[derive(Clone, Debug, PartialEq)]
pub struct DispersionCurve {
    /// Unit direction of propagation.
    pub direction: Vec3,
    /// Unit polarization vector.
    pub polarization: Vec3,
    /// Measured speeds, longest wave first.
    pub points: Vec<DispersionPoint>,
    /// Speed of long waves v₀, m/s.
    pub speed: f64,
    /// Standard deviation of v₀ from the errors of the points and of the law, m/s.
    pub stddev: f64,
    /// Coefficient b, m².
    pub dispersion_coefficient: f64,
}

impl DispersionCurve {
    /// Fits v² = v₀² (1 − b q²) to two or more points by weighted least squares.
    ///
    /// The standard deviation is that of the points, or their scatter about the law where it is larger; with three or
    /// more points it includes the change of v₀ by a term in q⁴. `None` with fewer than two different wavelengths, if a
    /// number is not finite and positive, or if v₀² is not positive.
    pub fn fit(direction: Vec3, polarization: Vec3, mut points: Vec<DispersionPoint>) -> Option<Self> {
        let valid = |x: f64| x.is_finite() && x > 0.0;
        if !points.iter().all(|p| valid(p.wavenumber) && valid(p.speed) && valid(p.stddev)) {
            return None;
        }
        points.sort_by(|a, b| a.wavenumber.total_cmp(&b.wavenumber));
        let straight = Fit::of(&points, 2)?;
        let scale = straight.scatter(&points).max(1.0);
        let mut variance = straight.variance * scale;
        if let Some(bent) = Fit::of(&points, 3) {
            let moved = bent.coefficients[0] - straight.coefficients[0];
            // A q⁴ term that is not significant changes v₀ by chance. The variance includes this part
            // already.
            variance += (moved * moved - (bent.variance * scale - variance).max(0.0)).max(0.0);
        }
        let square = straight.coefficients[0];
        let speed = (square > 0.0).then(|| square.sqrt())?;
        let stddev = variance.sqrt() / (2.0 * speed);
        let dispersion_coefficient = -straight.coefficients[1] / square;
        let curve = Self { direction, polarization, points, speed, stddev, dispersion_coefficient };
        stddev.is_finite().then_some(curve)
    }
}

/// v² as a polynomial in q².
struct Fit {
    coefficients: DVector<f64>,
    /// Variance of the first coefficient from the errors of the points, (m/s)⁴.
    variance: f64,
}

impl Fit {
    fn of(points: &[DispersionPoint], terms: usize) -> Option<Self> {
        let mut different: Vec<f64> = points.iter().map(|p| p.wavenumber).collect();
        different.dedup_by(|a, b| (*a - *b).abs() <= 1e-9 * *b);
        if different.len() < terms {
            return None;
        }
        // q² in units of the largest, so that columns are of the same scale.
        let unit = points.last()?.wavenumber.powi(2);
        let error = |p: &DispersionPoint| 2.0 * p.speed * p.stddev;
        let rows = DMatrix::from_fn(points.len(), terms, |i, k| {
            (points[i].wavenumber.powi(2) / unit).powi(k as i32) / error(&points[i])
        });
        let sides = DVector::from_fn(points.len(), |i, _| points[i].speed.powi(2) / error(&points[i]));
        let inverse = (rows.transpose() * &rows).try_inverse()?;
        let mut coefficients = &inverse * rows.transpose() * sides;
        for k in 1..terms {
            coefficients[k] /= unit.powi(k as i32);
        }
        Some(Self { coefficients, variance: inverse[(0, 0)] })
    }

    /// χ² per degree of freedom; 1 without degrees of freedom.
    fn scatter(&self, points: &[DispersionPoint]) -> f64 {
        let terms = self.coefficients.len();
        let freedom = points.len().saturating_sub(terms);
        if freedom == 0 {
            return 1.0;
        }
        let misfit = |p: &DispersionPoint| {
            let law: f64 = (0..terms).map(|k| self.coefficients[k] * p.wavenumber.powi(2 * k as i32)).sum();
            ((p.speed.powi(2) - law) / (2.0 * p.speed * p.stddev)).powi(2)
        };
        points.iter().map(misfit).sum::<f64>() / freedom as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(law: impl Fn(f64) -> f64, relative: f64) -> Vec<DispersionPoint> {
        let point = |q: f64| DispersionPoint { wavenumber: q, speed: law(q), stddev: relative * law(q) };
        [0.1, 0.2, 0.3, 0.4].map(point).to_vec()
    }

    fn through(points: Vec<DispersionPoint>) -> Option<DispersionCurve> {
        DispersionCurve::fit(Vec3::z(), Vec3::z(), points)
    }

    #[test]
    fn the_law_is_recovered() {
        let law = |q: f64| 300.0 * (1.0 - 0.15 * q * q).sqrt();
        let curve = through(points(law, 1e-3)).unwrap();
        assert!(
            (curve.speed - 300.0).abs() < 1e-9 && (curve.dispersion_coefficient - 0.15).abs() < 1e-9,
            "{curve:?}"
        );
    }

    #[test]
    fn the_uncertainty_includes_the_error_of_the_law() {
        // A chain: v² = (2/q)² sin²(q/2) = 1 − q²/12 + q⁴/360.
        let chain = |q: f64| 2.0 / q * (0.5 * q).sin();
        let far = |q: f64| chain(4.0 * q);
        for law in [&chain as &dyn Fn(f64) -> f64, &far] {
            let curve = through(points(law, 1e-9)).unwrap();
            let off = (curve.speed - 1.0).abs();
            assert!(off < 2.0 * curve.stddev && curve.stddev < 10.0 * off, "{off:e} {curve:?}");
        }
    }

    #[test]
    fn scatter_beyond_the_errors_widens_them() {
        let mut noisy = points(|_| 100.0, 1e-6);
        noisy[1].speed = 101.0;
        assert!(through(noisy).unwrap().stddev > 0.3);
    }

    #[test]
    fn points_without_a_fit_give_none() {
        assert!(through(points(|_| 100.0, 1e-3)[..1].to_vec()).is_none());
        let same = vec![DispersionPoint { wavenumber: 0.1, speed: 1.0, stddev: 0.1 }; 3];
        assert!(through(same).is_none());
        assert!(through(points(|_| f64::NAN, 1e-3)).is_none());
        assert!(through(points(|_| 100.0, 0.0)).is_none());
        // The speed falls so steeply with the wavelength that v₀² is negative.
        assert!(through(points(|q| 100.0 * (q - 0.099), 1e-3)).is_none());
    }
}
