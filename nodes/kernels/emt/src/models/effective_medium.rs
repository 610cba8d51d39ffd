//! The plain effective medium: absolute moduli, Eqs. 10–15, at the volume strain that gives the pressure.
//!
//! It needs no calibration, only grains, solid fraction and pressure. It over-predicts the shear moduli of
//! real packings several times and therefore infers k far too low; the ratio models avoid this.
//!
//! With r = G13/G12 and g, ε follows as in the ratio model; at given pressure the moduli are proportional to k^⅔, so
//! that G12 gives k (the paper's k_EMT, but with the Δ that gives the pressure). Θ, C11, C33 and C13 would each give
//! another k: they are not used, and their difference from the prediction is not reported, since it is the known error
//! of the model and not of the data.

use super::equivalent::MAX_COORDINATION;
use super::shear_ratio::{check_eq_10, ratio_notes, shear_ratio};
use crate::calibration::Calibration;
use crate::conditions::{Conditions, Measured};
use crate::domain::Domain;
use crate::eq16::Eq16Reading;
use crate::error::EmtError;
use crate::medium::Medium;
use crate::model::Model;
use crate::moduli::{Moduli, Modulus};
use crate::moments::eps_of_spin;
use crate::observation::Observation;
use crate::point_estimate::PointEstimate;
use grainlab_core::notes::Note;
use grainlab_core::results::{InferredQuantity, Microstructure};

/// Eqs. 12–15 with Eq. 13 corrected: model `emt`. It uses only the material of the calibration, where that of
/// the grains is not known.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EffectiveMedium;

const NAME: &str = "emt";

impl Model for EffectiveMedium {
    fn name(&self) -> &'static str {
        NAME
    }

    fn uses_constants(&self) -> bool {
        false
    }

    fn uses_gamma(&self) -> bool {
        true
    }

    fn domain(&self, _: &Calibration) -> Domain {
        let ranges = [(InferredQuantity::K, [0.1, MAX_COORDINATION]), (InferredQuantity::Eps, [-0.5, 1.0])];
        Domain { gamma: [-0.5, 0.25], needs_solid_fraction: true, ..Domain::new(NAME, &ranges) }
    }

    fn predict(
        &self,
        structure: &Microstructure,
        conditions: &Conditions,
        calibration: &Calibration,
    ) -> Result<Moduli, EmtError> {
        let found = self.domain(calibration).validate(structure, conditions)?;
        let [k, eps] = [InferredQuantity::K, InferredQuantity::Eps].map(|q| found[q as usize]);
        let moduli = medium(k, eps, conditions, calibration)?.moduli(Eq16Reading::Corrected);
        Ok(Moduli::of_medium(&moduli.stiffness().transverse_isotropy()))
    }

    fn solve(&self, observation: &Observation, calibration: &Calibration) -> Result<PointEstimate, EmtError> {
        let conditions = &observation.conditions;
        let g = check_eq_10(conditions.gamma.value)?;
        let ratio = shear_ratio(NAME, observation)?;
        let g12 = observation.moduli.get(Modulus::G12).ok_or(EmtError::missing(NAME, Modulus::G12))?;
        let eps = eps_of_spin(ratio - 1.0, g).ok_or(Note::no_anisotropy(ratio, g))?;
        let one_contact = medium(1.0, eps, conditions, calibration)?;
        // Beyond the domain, directions of negative contact density can outweigh the others.
        if one_contact.pressure() <= 0.0 {
            return Err(Note::no_anisotropy(ratio, g).into());
        }
        let k = (g12 / one_contact.moduli(Eq16Reading::Corrected).psi3).powf(1.5);
        let structure =
            Microstructure::default().with(InferredQuantity::K, k).with(InferredQuantity::Eps, eps);
        Ok(PointEstimate { notes: ratio_notes(ratio), ..PointEstimate::exact(structure) })
    }
}

fn medium(k: f64, eps: f64, conditions: &Conditions, calibration: &Calibration) -> Result<Medium, EmtError> {
    let missing = EmtError::Missing { model: NAME, missing: "the solid fraction" };
    let Measured { value: solid_fraction, .. } = conditions.solid_fraction.ok_or(missing)?;
    let material = conditions.material.unwrap_or(*calibration.material());
    let gamma_over_delta = conditions.gamma.value;
    let unstrained = Medium { material, solid_fraction, volume_strain: 0.0, k, eps, gamma_over_delta };
    Ok(unstrained.at_pressure(conditions.pressure.value))
}
