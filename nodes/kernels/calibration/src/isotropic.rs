//! Eqs. 21 and 22 from isotropic packings.

use crate::regression::linear;
use crate::requirements::packings;
use crate::sample::{CalibrationSample, bounds};
use crate::student::student;
use grainlab_emt::{CalibrationError, HALF_WIDTH, Invariants, IsotropicCalibration};

/// Fits Eqs. 21 and 22 by relative residuals, and refuses a slope whose 95 % interval contains 0. States of one packing at several
/// pressures are not independent: the covariance counts packings, not states.
pub(crate) fn of_isotropic(samples: &[CalibrationSample]) -> Result<IsotropicCalibration, CalibrationError> {
    let packings = packings(samples);
    // Each equation has two constants, and its scatter.
    if packings < 3 {
        return Err(CalibrationError::Packings { what: "isotropic packings", found: packings, needed: 3 });
    }
    let (low, high) = bounds(samples.iter().map(|s| s.k));
    let undetermined = |error: &str| {
        CalibrationError::Undetermined(format!(
            "the isotropic packings, k {low:.3} to {high:.3}, determine no slope by k{error}: prepare some of more different k, with \
             other friction"
        ))
    };
    let fit = |modulus: fn(&Invariants) -> f64| {
        let rows: Vec<_> = samples
            .iter()
            .filter_map(|s| {
                let reduced = modulus(&Invariants::of(&s.moduli)?).exp() / 1e6 / (s.pressure / 1e6).cbrt();
                Some(([s.k, 1.0], reduced, 1.0 / reduced))
            })
            .collect();
        let line = linear(&rows, "isotropic packings").map_err(|_| undetermined(""))?;
        let variance = line.squares / rows.len() as f64 * packings as f64 / (packings - 2) as f64;
        // From (slope, intercept) to (slope, intercept/slope).
        let (slope, ratio) = (line.coefficients[0], line.coefficients[1] / line.coefficients[0]);
        let jacobian = nalgebra::Matrix2::new(1.0, 0.0, -ratio / slope, 1.0 / slope);
        let inverse =
            line.inverse.fixed_view::<2, 2>(0, 0).into_owned() * (rows.len() as f64 / packings as f64);
        let covariance = jacobian * inverse * jacobian.transpose() * variance;
        let stddev = covariance[(0, 0)].sqrt();
        if slope.abs() <= HALF_WIDTH * student(packings - 2) * stddev {
            return Err(undetermined(&format!(", {slope:.3} +- {stddev:.3} (standard error)")));
        }
        Ok((slope, ratio, covariance, (line.squares / rows.len() as f64).sqrt()))
    };
    let (alpha, beta, of_shear, shear_scatter) = fit(|i| i.ln_shear)?;
    let (rho, zeta, of_theta, theta_scatter) = fit(|i| i.ln_theta)?;
    let mut isotropic = IsotropicCalibration::new([alpha, beta, rho, zeta], [low, high])?;
    let mut covariance = [[0.0; 4]; 4];
    for i in 0..2 {
        for j in 0..2 {
            covariance[i][j] = of_shear[(i, j)];
            covariance[2 + i][2 + j] = of_theta[(i, j)];
        }
    }
    isotropic.covariance = Some(covariance);
    isotropic.scatter = Some([shear_scatter, theta_scatter]);
    Ok(isotropic)
}
