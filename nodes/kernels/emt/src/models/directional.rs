//! Each modulus with its own coordination number: G_ij = α(k·3 m_ij + β) p^⅓, Θ = ρ(k + ζ) p^⅓ with the constants of
//! Eqs. 21 and 22, and 3 m_ij the fraction of contacts that carry shear in the plane ij, 1 in an isotropic packing.
//!
//! The constants α and β contain the effect of the network's relaxation on the shear modulus, which amplifies
//! the effect of ε on G13/G12 by k/(k + β); γ/Δ is not needed. Two of G12, G13 and Θ give k and ε. With all
//! three, k and ε minimise the sum of squares of the relative deviations. On the rows of the paper this is
//! the best model that uses three moduli; on packings of the calibration `grainlab` the amplification is too
//! large.

use super::equivalent::fitted;
use crate::calibration::{Calibration, IsotropicCalibration};
use crate::conditions::Conditions;
use crate::domain::{Domain, outside_fitted};
use crate::error::EmtError;
use crate::model::Model;
use crate::moduli::{MODULI, Moduli, Modulus};
use crate::observation::Observation;
use crate::point_estimate::{Jacobian, PointEstimate};
use grainlab_core::notes::Note;
use grainlab_core::results::{InferredQuantity, Microstructure};
use nalgebra::{Matrix2x3, Matrix3x2, Vector2, Vector3};

/// Directional coordination numbers: model `directional`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Directional;

const NAME: &str = "directional";

/// Largest |ε| of the domain: beyond it the weakest direction of a loose packing would have no stiffness.
const MAX_EPS: f64 = 0.3;

/// Maximum number of Gauss–Newton steps; four suffice near a solution.
const STEPS: usize = 100;

impl Model for Directional {
    fn name(&self) -> &'static str {
        NAME
    }

    fn domain(&self, calibration: &Calibration) -> Domain {
        let weakest = shares(MAX_EPS)[0].min(shares(-MAX_EPS)[1]);
        let lowest = -1.05 * calibration.isotropic().constants()[1] / weakest;
        let ranges = [(InferredQuantity::K, [lowest, 12.0]), (InferredQuantity::Eps, [-MAX_EPS, MAX_EPS])];
        let fitted = fitted(InferredQuantity::K, calibration);
        Domain { fitted, ..Domain::new(NAME, &ranges) }
    }

    fn predict(
        &self,
        structure: &Microstructure,
        conditions: &Conditions,
        calibration: &Calibration,
    ) -> Result<Moduli, EmtError> {
        let found = self.domain(calibration).validate(structure, conditions)?;
        let isotropic = calibration.isotropic_for(conditions.material);
        let [k, eps] = [InferredQuantity::K, InferredQuantity::Eps].map(|q| found[q as usize]);
        let (moduli, _) = forward(&isotropic, conditions.pressure.value, k, eps);
        Ok(Moduli::paper(moduli[0], moduli[1], moduli[2]))
    }

    fn solve(&self, observation: &Observation, calibration: &Calibration) -> Result<PointEstimate, EmtError> {
        let isotropic = calibration.isotropic_for(observation.conditions.material);
        let given = [Modulus::G12, Modulus::G13, Modulus::Theta].map(|m| observation.moduli.get(m));
        if given.iter().flatten().count() < 2 {
            return Err(EmtError::Missing { model: NAME, missing: "two of G12, G13 and Theta" });
        }
        let (found, gain) = least_squares(&isotropic, observation.pressure(), given).ok_or_else(|| {
            let [low, high] = isotropic.fitted;
            let calibration = calibration.name().to_owned();
            let nearest = start(&isotropic, observation.pressure(), given);
            EmtError::from(Note::no_coordination(calibration, nearest, low, high))
        })?;
        let (k, eps) = (found[0], found[1]);
        let nu = observation.conditions.material.unwrap_or(*calibration.material()).poisson_ratio;
        let mut jacobian = Jacobian::zeros();
        for (row, quantity) in [InferredQuantity::K, InferredQuantity::Eps].into_iter().enumerate() {
            for i in 0..3 {
                jacobian[(quantity as usize, i)] = gain[(row, i)];
                // All moduli are proportional to the cube root of the pressure.
                jacobian[(quantity as usize, MODULI)] -= gain[(row, i)] / 3.0;
                // And to E*^⅔, with E* = G/(1 − ν).
                let by_young = gain[(row, i)] * 2.0 / 3.0;
                jacobian[(quantity as usize, MODULI + 5)] -= by_young;
                jacobian[(quantity as usize, MODULI + 6)] -= by_young / (1.0 - nu);
            }
        }
        let structure =
            Microstructure::default().with(InferredQuantity::K, k).with(InferredQuantity::Eps, eps);
        let notes = outside_fitted(&fitted(InferredQuantity::K, calibration), &structure);
        Ok(PointEstimate { jacobian: Some(jacobian), notes, ..PointEstimate::exact(structure) })
    }
}

/// 3 m12 and 3 m13, the latter from the sum of the compliances of both directions of the plane, and their derivatives
/// with respect to ε.
fn shares_and_slopes(eps: f64) -> [(f64, f64); 2] {
    let (radial, axial) = (1.0 - 0.4 * eps, 1.0 + 0.8 * eps);
    let sum = radial + axial;
    let mixed = 2.0 * radial * axial / sum;
    let slope = (2.0 * (0.8 * radial - 0.4 * axial) - 0.4 * mixed) / sum;
    [(radial, -0.4), (mixed, slope)]
}

fn shares(eps: f64) -> [f64; 2] {
    shares_and_slopes(eps).map(|(share, _)| share)
}

/// G12, G13 and Θ, Pa, and their derivatives with respect to k and ε.
fn forward(
    isotropic: &IsotropicCalibration,
    pressure: f64,
    k: f64,
    eps: f64,
) -> (Vector3<f64>, Matrix3x2<f64>) {
    let shear_slope = isotropic.shear_modulus(1.0, pressure) - isotropic.shear_modulus(0.0, pressure);
    let bulk_slope = isotropic.bulk_modulus(1.0, pressure) - isotropic.bulk_modulus(0.0, pressure);
    let [(m12, by12), (m13, by13)] = shares_and_slopes(eps);
    let moduli = Vector3::new(
        isotropic.shear_modulus(k * m12, pressure),
        isotropic.shear_modulus(k * m13, pressure),
        isotropic.bulk_modulus(k, pressure),
    );
    let slopes = Matrix3x2::new(
        shear_slope * m12,
        shear_slope * k * by12,
        shear_slope * m13,
        shear_slope * k * by13,
        bulk_slope,
        0.0,
    );
    (moduli, slopes)
}

/// The coordination number of an isotropic packing with this Θ or, without Θ, this mean shear modulus.
fn start(isotropic: &IsotropicCalibration, pressure: f64, [g12, g13, theta]: [Option<f64>; 3]) -> f64 {
    let unit = 1e6 * (pressure / 1e6).cbrt();
    let [alpha, beta, rho, zeta] = isotropic.constants();
    let of_theta = theta.map(|t| t / (rho * unit) - zeta);
    let of_shear =
        [g12, g13].into_iter().flatten().map(|g| g / (alpha * unit) - beta).reduce(|a, b| 0.5 * (a + b));
    of_theta.or(of_shear).unwrap_or(0.0)
}

/// (k, ε), and their changes per relative change of G12, G13 and Θ.
type Found = (Vector2<f64>, Matrix2x3<f64>);

/// Gauss–Newton with step halving; `None` where it does not converge, or to a negative coordination number or
/// stiffness.
fn least_squares(isotropic: &IsotropicCalibration, pressure: f64, given: [Option<f64>; 3]) -> Option<Found> {
    let weight = Vector3::from(given.map(|g| g.map_or(0.0, |g| 1.0 / g)));
    let value = Vector3::from(given.map(|g| g.unwrap_or(0.0)));
    let at = |found: Vector2<f64>| {
        let (moduli, mut slopes) = forward(isotropic, pressure, found[0], found[1]);
        slopes.column_iter_mut().for_each(|mut c| c.component_mul_assign(&weight));
        ((value - moduli).component_mul(&weight), slopes)
    };
    let mut found = Vector2::new(start(isotropic, pressure, given), 0.0);
    for _ in 0..STEPS {
        let (residual, slopes) = at(found);
        let gain = (slopes.transpose() * slopes).try_inverse()? * slopes.transpose();
        let step = gain * residual;
        if !step.iter().all(|s| s.is_finite()) {
            return None;
        }
        let mut share = 1.0;
        // An increase by rounding alone is accepted.
        let enough = residual.norm() + 4.0 * f64::EPSILON;
        while share > 1e-9 && at(found + step * share).0.norm() > enough {
            share *= 0.5;
        }
        let settled = step[0].abs() < 1e-11 * found[0].abs() && step[1].abs() < 1e-11;
        if settled || share <= 1e-9 {
            let stiff = shares(found[1]).iter().all(|share| *share > 0.0);
            return (stiff && found[0] > 0.0).then_some((found, gain));
        }
        found += step * share;
    }
    None
}
