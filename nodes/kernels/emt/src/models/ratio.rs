//! The paper's models: moduli as ratios over those of an equivalent isotropic packing, Eqs. 16–18 with 21 and 22.
//!
//! The inversion is closed and unique in every reading. With r = G13/G12 and a = r − 1, ε follows from a and g alone.
//! With B the bracket of Eq. 16, s = (ρ/α)(G12/Θ) B/(3 m1) = (k̂+β)/(k̂+ζ) gives k̂, and Θ then gives k. In the
//! corrected reading B/(3 m1) = (4−r)/(3(2−r)): k̂ depends on neither g nor ε.

use super::equivalent::{Factors, domain};
use super::shear_ratio::{check_eq_10, shear_ratio};
use crate::calibration::Calibration;
use crate::conditions::Conditions;
use crate::domain::Domain;
use crate::eq16::Eq16Reading;
use crate::error::EmtError;
use crate::model::Model;
use crate::moduli::Moduli;
use crate::moments::{Moments, eps_of_spin};
use crate::observation::Observation;
use crate::point_estimate::PointEstimate;
use grainlab_core::notes::Note;
use grainlab_core::results::{InferredQuantity, Microstructure};

/// The ratio model in one reading of Eqs. 16–18.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ratio {
    name: &'static str,
    reading: Eq16Reading,
}

/// Eq. 16 with its missing factor: model `ratio`.
pub(crate) const CORRECTED: Ratio = Ratio { name: "ratio", reading: Eq16Reading::Corrected };

/// Eq. 16 as it is printed: model `ratio-as-printed`.
pub(crate) const AS_PRINTED: Ratio = Ratio { name: "ratio-as-printed", reading: Eq16Reading::AsPrinted };

impl Model for Ratio {
    fn name(&self) -> &'static str {
        self.name
    }

    fn uses_gamma(&self) -> bool {
        true
    }

    fn domain(&self, calibration: &Calibration) -> Domain {
        domain(self.name, calibration)
    }

    fn predict(
        &self,
        structure: &Microstructure,
        conditions: &Conditions,
        calibration: &Calibration,
    ) -> Result<Moduli, EmtError> {
        let found = self.domain(calibration).validate(structure, conditions)?;
        let (eps, g) = (found[InferredQuantity::Eps as usize], conditions.gamma.value);
        let factors = self.factors(eps, Moments::new(eps, g).spin(), g);
        Ok(factors.moduli(&found, conditions, calibration))
    }

    fn solve(&self, observation: &Observation, calibration: &Calibration) -> Result<PointEstimate, EmtError> {
        let g = check_eq_10(observation.conditions.gamma.value)?;
        let ratio = shear_ratio(self.name, observation)?;
        let a = ratio - 1.0;
        let no_anisotropy = EmtError::from(Note::no_anisotropy(ratio, g));
        let eps = eps_of_spin(a, g).ok_or(no_anisotropy.clone())?;
        let factors = self.factors(eps, a, g);
        if factors.bulk <= 0.0 {
            return Err(no_anisotropy);
        }
        factors.point_estimate(eps, observation, calibration)
    }
}

impl Ratio {
    /// Brackets of Eqs. 16–18, with a as an independent variable.
    fn factors(&self, eps: f64, a: f64, g: f64) -> Factors {
        let g12 = 3.0 * Moments::new(eps, g).m1;
        Factors { g12, g13: g12 * (1.0 + a), bulk: self.reading.bulk(eps, a, g) }
    }
}
