//! The paper's models: moduli as ratios over those of an equivalent isotropic packing, Eqs. 16–18 with 21 and 22.
//!
//! The inversion is closed and unique in both forms. With r = G13/G12 and a = r − 1, ε follows from a and g alone. With
//! B the bracket of Eq. 16, s = (ρ/α)(G12/Θ) B/(3 m1) = (k̂+β)/(k̂+ζ) gives k̂, and Θ then gives k. In the corrected form
//! B/(3 m1) = (4−r)/(3(2−r)): k̂ depends on neither g nor ε.

use crate::calibration::Calibration;
use crate::error::EmtError;
use crate::estimate::{Estimate, Status, Structure, Warning, warnings};
use crate::form::{Form, m1_by_eps, m1_by_g};
use crate::model::Model;
use crate::moments::{Moments, eps_of_spin};
use crate::observation::{Gamma, Observation};
use nalgebra::{Matrix3x5, RowVector5};

/// The ratio model in one reading of Eq. 16.
#[derive(Clone, Copy, Debug)]
pub struct Ratio {
    name: &'static str,
    form: Form,
}

/// Eq. 16 with its missing factor: model `ratio`.
pub const CORRECTED: Ratio = Ratio { name: "ratio", form: Form::Corrected };

/// Eq. 16 as it is printed: model `ratio-as-printed`.
pub const AS_PRINTED: Ratio = Ratio { name: "ratio-as-printed", form: Form::AsPrinted };

impl Model for Ratio {
    fn name(&self) -> &'static str {
        self.name
    }

    fn predict(
        &self,
        structure: &Structure,
        gamma: Gamma,
        pressure: f64,
        calibration: &Calibration,
    ) -> Observation {
        let Structure { k, k_hat, eps } = *structure;
        let m = Moments::new(eps, gamma.value);
        let g12 = k / k_hat * 3.0 * m.m1 * calibration.shear_modulus(k_hat, pressure);
        let g13 = g12 * (1.0 + m.spin());
        let bulk = self.form.bulk_factor(eps, gamma.value);
        let theta = k / k_hat * bulk * calibration.bulk_modulus(k_hat, pressure);
        Observation::new(g12, g13, theta, pressure, gamma)
    }

    fn infer(&self, observation: &Observation, calibration: &Calibration) -> Result<Estimate, EmtError> {
        observation.check()?;
        let ratio = observation.g13 / observation.g12;
        let (structure, jacobian) = invert(self.form, observation, calibration)?;
        let covariance = observation.log_covariance().map(|input| jacobian * input * jacobian.transpose());
        // Finite inputs of absurd scale can still overflow.
        for value in [structure.k].iter().chain(covariance.iter().flatten()) {
            if !value.is_finite() {
                return Err(EmtError::NotFinite { quantity: "the estimate", value: *value });
            }
        }
        let warnings = warnings(&structure, ratio, &observation.gamma, calibration);
        let extrapolated = warnings.iter().any(Warning::is_extrapolation);
        Ok(Estimate {
            model: self.name,
            calibration: calibration.name().to_owned(),
            gamma: observation.gamma,
            structure,
            covariance,
            status: if extrapolated { Status::Extrapolated } else { Status::Ok },
            warnings,
        })
    }
}

/// The structure, and the slopes of (k, k̂, ε) by (ln G12, ln G13, ln Θ, ln p, g).
fn invert(
    form: Form,
    observation: &Observation,
    calibration: &Calibration,
) -> Result<(Structure, Matrix3x5<f64>), EmtError> {
    let Observation { g12, g13, theta, pressure, .. } = *observation;
    let g = observation.gamma.value;
    let ratio = g13 / g12;
    if !(ratio > 0.0 && ratio < 2.0) {
        return Err(EmtError::RatioOutOfRange { ratio });
    }
    let a = ratio - 1.0;
    let no_anisotropy = EmtError::NoAnisotropy { ratio, g };
    let (eps, eps_by_a, eps_by_g) = eps_of_spin(a, g).ok_or(no_anisotropy.clone())?;
    let m1 = Moments::new(eps, g).m1;
    let bulk = form.bulk(eps, a, g);
    if bulk.value <= 0.0 {
        return Err(no_anisotropy);
    }
    let isotropic = bulk.value / (3.0 * m1);
    let s = calibration.reduced(g12 / theta * isotropic);
    if s >= 1.0 {
        let limit = 1.0 / calibration.reduced(isotropic);
        return Err(EmtError::ShearTooStiff {
            ratio: g12 / theta,
            limit,
            calibration: calibration.name().into(),
        });
    }
    let (k_hat, k_hat_by_s) = calibration.coordination(s);
    let k = k_hat * theta / (calibration.bulk_modulus(k_hat, pressure) * bulk.value);

    let ln = |i: usize| RowVector5::from_fn(|_, j| if i == j { 1.0 } else { 0.0 });
    let (ln_g12, ln_g13, ln_theta, ln_p, d_g) = (ln(0), ln(1), ln(2), ln(3), ln(4));
    let d_a = (ln_g13 - ln_g12) * ratio;
    let d_eps = d_a * eps_by_a + d_g * eps_by_g;
    let ln_bulk = (d_eps * bulk.by_eps + d_a * bulk.by_a + d_g * bulk.by_g) / bulk.value;
    let ln_m1 = (d_eps * m1_by_eps(g) + d_g * m1_by_g(eps)) / m1;
    let d_k_hat = (ln_g12 - ln_theta + ln_bulk - ln_m1) * (s * k_hat_by_s);
    let ln_k = ln_theta - ln_p / 3.0 + d_k_hat * calibration.bulk_sensitivity(k_hat) - ln_bulk;
    Ok((Structure { k, k_hat, eps }, Matrix3x5::from_rows(&[ln_k * k, d_k_hat, d_eps])))
}
