//! The equivalent isotropic packing, against which the ratio models measure.
//!
//! Moduli of an anisotropic packing over those of an isotropic one with coordination number k̂ are (k/k̂)^power times
//! factors that only the contact distribution decides. With G and Θ of Eqs. 21 and 22, G12/Θ gives k̂ alone, and Θ then
//! gives k: closed and unique.

use crate::calibration::Calibration;
use crate::conditions::Conditions;
use crate::error::EmtError;
use crate::model::Solution;
use crate::moduli::{Moduli, Modulus};
use crate::observation::Observation;
use crate::ratio::{outside_fit, ratio_warnings};
use crate::structure::{QUANTITIES, Quantity, Structure};

/// Moduli over those of an isotropic packing with as many contacts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factors {
    /// Of G12 over the isotropic shear modulus. Positive.
    pub(crate) g12: f64,
    /// Of G13 over the same.
    pub(crate) g13: f64,
    /// Of the bulk modulus. Positive.
    pub(crate) bulk: f64,
}

impl Factors {
    /// The moduli of a packing with the coordination numbers of `found`, a structure of [`crate::ratio::domain`] in the
    /// order of [`Quantity::ALL`].
    pub(crate) fn moduli(
        &self,
        found: &[f64; QUANTITIES],
        power: f64,
        conditions: &Conditions,
        calibration: &Calibration,
    ) -> Moduli {
        let isotropic = calibration.isotropic_for(conditions.material);
        let [k, k_hat] = [isotropic.abscissa, Quantity::KHat].map(|q| found[q as usize]);
        let pressure = conditions.pressure.value;
        let denser = (k / k_hat).powf(power);
        let shear = denser * isotropic.shear_modulus(k_hat, pressure);
        let bulk = denser * isotropic.bulk_modulus(k_hat, pressure);
        Moduli::paper(self.g12 * shear, self.g13 * shear, self.bulk * bulk)
    }

    /// The structure of contact anisotropy `eps` that has the moduli observed, and what to say of it; without Θ its
    /// coordination numbers stay undetermined.
    pub(crate) fn solution(
        &self,
        eps: f64,
        power: f64,
        observation: &Observation,
        calibration: &Calibration,
    ) -> Result<Solution, EmtError> {
        let structure = Structure::default().with(Quantity::Eps, eps);
        let [g12, g13, theta] =
            [Modulus::G12, Modulus::G13, Modulus::Theta].map(|m| observation.moduli.get(m));
        let mut warnings = g12.zip(g13).map_or(Vec::new(), |(g12, g13)| ratio_warnings(g13 / g12));
        let Some((g12, theta)) = g12.zip(theta) else {
            return Ok(Solution { warnings, ..Solution::exact(structure) });
        };
        let isotropic = calibration.isotropic_for(observation.conditions.material);
        let of_isotropic = self.bulk / self.g12;
        let s = isotropic.reduced(g12 / theta * of_isotropic);
        if s >= 1.0 {
            return Err(EmtError::ShearTooStiff {
                ratio: g12 / theta,
                limit: 1.0 / isotropic.reduced(of_isotropic),
                calibration: calibration.name().into(),
            });
        }
        let k_hat = isotropic.coordination(s);
        let denser = theta / (isotropic.bulk_modulus(k_hat, observation.pressure()) * self.bulk);
        let k = k_hat * if power == 1.0 { denser } else { denser.powf(1.0 / power) };
        warnings.extend(outside_fit(Quantity::KHat, k_hat, calibration));
        let structure = structure.with(isotropic.abscissa, k).with(Quantity::KHat, k_hat);
        Ok(Solution { warnings, ..Solution::exact(structure) })
    }
}
