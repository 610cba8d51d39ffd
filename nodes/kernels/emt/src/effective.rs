//! The plain effective medium: absolute moduli, Eqs. 10–15, under the pressure that closes the volume strain.
//!
//! Needs no packing to learn from, only grains, solid fraction and pressure. It over-predicts the shear of real packings
//! several times, and so finds k far too low: the reason for the ratio models.
//!
//! With r = G13/G12 and g, ε follows as in the ratio model; at given pressure the moduli go with k^⅔, so that G12 gives k
//! (the paper's k_EMT, but with the Δ of the pressure). Θ, C11, C33 and C13 would each give a k of its own: they are not
//! read, and nothing is said of how far they are from what the model has for them, since that is the model's known error
//! and none of the data's.

use crate::calibration::Calibration;
use crate::conditions::{Conditions, Measured};
use crate::domain::Domain;
use crate::error::EmtError;
use crate::form::Form;
use crate::medium::Medium;
use crate::model::{Model, Solution};
use crate::moduli::{Moduli, Modulus};
use crate::moments::eps_of_spin;
use crate::observation::Observation;
use crate::ratio::{HIGHEST, check_eq_10, ratio_warnings, shear_ratio};
use crate::structure::{QUANTITIES, Quantity, Structure};

/// Eqs. 12–15 with Eq. 13 corrected: model `emt`. Grains of unknown material are those of the calibration, of which it
/// uses nothing else.
#[derive(Clone, Copy, Debug)]
pub struct Effective;

const NAME: &str = "emt";

impl Model for Effective {
    fn name(&self) -> &'static str {
        NAME
    }

    fn domain(&self, _: &Calibration) -> Domain {
        let mut structure = [None; QUANTITIES];
        structure[Quantity::K as usize] = Some([0.1, HIGHEST]);
        structure[Quantity::Eps as usize] = Some([-0.5, 1.0]);
        Domain {
            model: NAME,
            structure,
            gamma: [-0.5, 0.25],
            poisson_ratio: [0.0, 0.5],
            needs_solid_fraction: true,
        }
    }

    fn predict(
        &self,
        structure: &Structure,
        conditions: &Conditions,
        calibration: &Calibration,
    ) -> Result<Moduli, EmtError> {
        let found = self.domain(calibration).take(structure, conditions)?;
        let [k, eps] = [Quantity::K, Quantity::Eps].map(|q| found[q as usize]);
        let psi = medium(k, eps, conditions, calibration)?.psi(Form::Corrected);
        Ok(Moduli::of_medium(&psi.stiffness().transverse_isotropy()))
    }

    fn solve(&self, observation: &Observation, calibration: &Calibration) -> Result<Solution, EmtError> {
        let conditions = &observation.conditions;
        let g = check_eq_10(conditions.gamma.value)?;
        let ratio = shear_ratio(NAME, observation)?;
        let g12 = observation.moduli.get(Modulus::G12).ok_or(EmtError::missing(NAME, Modulus::G12))?;
        let eps = eps_of_spin(ratio - 1.0, g).ok_or(EmtError::NoAnisotropy { ratio, g })?;
        let one_contact = medium(1.0, eps, conditions, calibration)?;
        // Beyond the domain, directions of less than no contacts can outweigh the others.
        if one_contact.pressure() <= 0.0 {
            return Err(EmtError::NoAnisotropy { ratio, g });
        }
        let k = (g12 / one_contact.psi(Form::Corrected).psi3).powf(1.5);
        let structure = Structure::default().with(Quantity::K, k).with(Quantity::Eps, eps);
        Ok(Solution { warnings: ratio_warnings(ratio), ..Solution::exact(structure) })
    }
}

/// The medium of this structure in this state.
fn medium(k: f64, eps: f64, conditions: &Conditions, calibration: &Calibration) -> Result<Medium, EmtError> {
    let missing = EmtError::Missing { model: NAME, missing: "the solid fraction" };
    let Measured { value: solid_fraction, .. } = conditions.solid_fraction.ok_or(missing)?;
    let material = conditions.material.unwrap_or(*calibration.material());
    let gamma_over_delta = conditions.gamma.value;
    let at_rest = Medium { material, solid_fraction, volume_strain: 0.0, k, eps, gamma_over_delta };
    Ok(at_rest.under(conditions.pressure.value))
}
