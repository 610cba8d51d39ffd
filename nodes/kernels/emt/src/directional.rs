//! Each modulus by its own coordination number: G_ij = α(k·3 m_ij + β) p^⅓, Θ = ρ(k + ζ) p^⅓ with the constants of
//! Eqs. 21 and 22, and 3 m_ij the share of contacts that shear in the plane ij meets, 1 in an isotropic packing.
//!
//! The constants α and β hold what a network's relaxation does to the shear modulus, so that ε comes out amplified by
//! k/(k + β) without any γ/Δ. Any two of G12, G13 and Θ give k and ε; of three, the least squares of their relative
//! deviations. On the paper's own rows this is the best of the models with three moduli; on packings of ours it amplifies
//! too much.

use crate::calibration::{Calibration, Isotropic};
use crate::conditions::Conditions;
use crate::domain::Domain;
use crate::error::EmtError;
use crate::model::{Model, Slopes, Solution};
use crate::moduli::{MODULI, Moduli, Modulus};
use crate::observation::Observation;
use crate::ratio::outside_fit;
use crate::structure::{QUANTITIES, Quantity, Structure};
use nalgebra::{Matrix2x3, Matrix3x2, Vector2, Vector3};

/// Directional coordination numbers: model `directional`.
#[derive(Clone, Copy, Debug)]
pub struct Directional;

const NAME: &str = "directional";

/// |ε| of the domain: beyond, weak directions of loose packings would have no stiffness.
const REACH: f64 = 0.3;

/// Gauss–Newton steps: four do near a solution.
const STEPS: usize = 100;

impl Model for Directional {
    fn name(&self) -> &'static str {
        NAME
    }

    fn uses_gamma(&self) -> bool {
        false
    }

    fn domain(&self, calibration: &Calibration) -> Domain {
        let isotropic = calibration.isotropic();
        let weakest = shares(REACH)[0].min(shares(-REACH)[1]);
        let mut structure = [None; QUANTITIES];
        structure[isotropic.abscissa as usize] = Some([-1.05 * isotropic.constants()[1] / weakest, 12.0]);
        structure[Quantity::Eps as usize] = Some([-REACH, REACH]);
        Domain {
            model: NAME,
            structure,
            gamma: [-1.0, 1.0],
            poisson_ratio: [0.0, 0.5],
            needs_solid_fraction: false,
        }
    }

    fn predict(
        &self,
        structure: &Structure,
        conditions: &Conditions,
        calibration: &Calibration,
    ) -> Result<Moduli, EmtError> {
        let found = self.domain(calibration).take(structure, conditions)?;
        let isotropic = calibration.isotropic_for(conditions.material);
        let [k, eps] = [isotropic.abscissa, Quantity::Eps].map(|q| found[q as usize]);
        let (moduli, _) = forward(&isotropic, conditions.pressure.value, k, eps);
        Ok(Moduli::paper(moduli[0], moduli[1], moduli[2]))
    }

    fn solve(&self, observation: &Observation, calibration: &Calibration) -> Result<Solution, EmtError> {
        let isotropic = calibration.isotropic_for(observation.conditions.material);
        let given = [Modulus::G12, Modulus::G13, Modulus::Theta].map(|m| observation.moduli.get(m));
        if given.iter().flatten().count() < 2 {
            return Err(EmtError::Missing { model: NAME, missing: "two of G12, G13 and Theta" });
        }
        let (found, gain) = least_squares(&isotropic, observation.pressure(), given).ok_or_else(|| {
            let [low, high] = isotropic.fitted;
            let calibration = calibration.name().to_owned();
            EmtError::NoCoordination {
                nearest: start(&isotropic, observation.pressure(), given),
                low,
                high,
                calibration,
            }
        })?;
        let (k, eps) = (found[0], found[1]);
        let mut slopes = Slopes::zeros();
        for (row, quantity) in [isotropic.abscissa, Quantity::Eps].into_iter().enumerate() {
            for i in 0..3 {
                slopes[(quantity as usize, i)] = gain[(row, i)];
                // All moduli go with the cube root of the pressure.
                slopes[(quantity as usize, MODULI)] -= gain[(row, i)] / 3.0;
            }
        }
        let structure = Structure::default().with(isotropic.abscissa, k).with(Quantity::Eps, eps);
        let warnings = outside_fit(isotropic.abscissa, k, calibration).into_iter().collect();
        Ok(Solution { slopes: Some(slopes), warnings, ..Solution::exact(structure) })
    }
}

/// 3 m12 and 3 m13, which sums the compliances of both directions of the plane, and their slopes by ε.
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

/// G12, G13 and Θ, Pa, and their slopes by k and ε.
fn forward(isotropic: &Isotropic, pressure: f64, k: f64, eps: f64) -> (Vector3<f64>, Matrix3x2<f64>) {
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

/// The coordination number that the moduli have in the mean, were they isotropic.
fn start(isotropic: &Isotropic, pressure: f64, [g12, g13, theta]: [Option<f64>; 3]) -> f64 {
    let unit = 1e6 * (pressure / 1e6).cbrt();
    let [alpha, beta, rho, zeta] = isotropic.constants();
    let of_theta = theta.map(|t| t / (rho * unit) - zeta);
    let of_shear =
        [g12, g13].into_iter().flatten().map(|g| g / (alpha * unit) - beta).reduce(|a, b| 0.5 * (a + b));
    of_theta.or(of_shear).unwrap_or(0.0)
}

/// k, ε, and their changes per relative change of G12, G13 and Θ.
type Found = (Vector2<f64>, Matrix2x3<f64>);

/// Gauss–Newton, halving what does not improve; `None` where it does not settle on something that a packing can have.
fn least_squares(isotropic: &Isotropic, pressure: f64, given: [Option<f64>; 3]) -> Option<Found> {
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
        // Rounding alone is no deterioration.
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
