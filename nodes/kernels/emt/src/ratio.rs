//! The paper's models: moduli as ratios over those of an equivalent isotropic packing, Eqs. 16–18 with 21 and 22.
//!
//! The inversion is closed and unique in every form. With r = G13/G12 and a = r − 1, ε follows from a and g alone. With
//! B the bracket of Eq. 16, s = (ρ/α)(G12/Θ) B/(3 m1) = (k̂+β)/(k̂+ζ) gives k̂, and Θ then gives k. In the corrected form
//! B/(3 m1) = (4−r)/(3(2−r)): k̂ depends on neither g nor ε.

use crate::calibration::Calibration;
use crate::conditions::Conditions;
use crate::domain::Domain;
use crate::equivalent::Factors;
use crate::error::EmtError;
use crate::form::Form;
use crate::model::{Model, Solution};
use crate::moduli::{Moduli, Modulus};
use crate::moments::{Moments, eps_of_spin};
use crate::observation::Observation;
use crate::structure::{QUANTITIES, Quantity, Structure};
use crate::warning::Warning;

/// The ratio model in one reading of Eqs. 16–18.
#[derive(Clone, Copy, Debug)]
pub struct Ratio {
    name: &'static str,
    form: Form,
    /// Power of k/k̂ in Eqs. 16–18.
    power: f64,
}

/// Eq. 16 with its missing factor: model `ratio`.
pub const CORRECTED: Ratio = Ratio { name: "ratio", form: Form::Corrected, power: 1.0 };

/// Eq. 16 as it is printed: model `ratio-as-printed`.
pub const AS_PRINTED: Ratio = Ratio { name: "ratio-as-printed", form: Form::AsPrinted, power: 1.0 };

/// At the same pressure and volume, as the text has it, Hertz contacts have moduli ∝ k^⅔ and not ∝ k: model
/// `ratio-volume`.
pub const VOLUME: Ratio = Ratio { name: "ratio-volume", form: Form::Corrected, power: 2.0 / 3.0 };

/// Highest coordination number of the domain: more than equal spheres find room for.
pub(crate) const HIGHEST: f64 = 15.0;

impl Model for Ratio {
    fn name(&self) -> &'static str {
        self.name
    }

    fn domain(&self, calibration: &Calibration) -> Domain {
        domain(self.name, calibration)
    }

    fn predict(
        &self,
        structure: &Structure,
        conditions: &Conditions,
        calibration: &Calibration,
    ) -> Result<Moduli, EmtError> {
        let found = self.domain(calibration).take(structure, conditions)?;
        let (eps, g) = (found[Quantity::Eps as usize], conditions.gamma.value);
        let factors = self.factors(eps, Moments::new(eps, g).spin(), g);
        Ok(factors.moduli(&found, self.power, conditions, calibration))
    }

    fn solve(&self, observation: &Observation, calibration: &Calibration) -> Result<Solution, EmtError> {
        let g = check_eq_10(observation.conditions.gamma.value)?;
        let ratio = shear_ratio(self.name, observation)?;
        let a = ratio - 1.0;
        let no_anisotropy = EmtError::NoAnisotropy { ratio, g };
        let eps = eps_of_spin(a, g).ok_or(no_anisotropy.clone())?;
        let factors = self.factors(eps, a, g);
        if factors.bulk <= 0.0 {
            return Err(no_anisotropy);
        }
        factors.solution(eps, self.power, observation, calibration)
    }
}

impl Ratio {
    /// Brackets of Eqs. 16–18, with a as a variable of its own.
    fn factors(&self, eps: f64, a: f64, g: f64) -> Factors {
        let g12 = 3.0 * Moments::new(eps, g).m1;
        Factors { g12, g13: g12 * (1.0 + a), bulk: self.form.bulk(eps, a, g) }
    }
}

/// Of a model with the paper's three unknowns: k (or z, as the calibration has it), k̂ above the zero of shear, and ε.
pub(crate) fn domain(model: &'static str, calibration: &Calibration) -> Domain {
    let isotropic = calibration.isotropic();
    let mut structure = [None; QUANTITIES];
    structure[isotropic.abscissa as usize] = Some([0.1, HIGHEST]);
    // At the zero of shear itself nothing can be inverted.
    structure[Quantity::KHat as usize] = Some([-isotropic.constants()[1] * (1.0 + 1e-3), HIGHEST]);
    structure[Quantity::Eps as usize] = Some([-0.5, 1.0]);
    Domain { model, structure, gamma: [-0.5, 0.25], poisson_ratio: [0.0, 0.5], needs_solid_fraction: false }
}

/// G13/G12, which is below 2 in every theory here.
pub(crate) fn shear_ratio(model: &'static str, observation: &Observation) -> Result<f64, EmtError> {
    let need = |m| observation.moduli.get(m).ok_or(EmtError::missing(model, m));
    let (g12, g13) = (need(Modulus::G12)?, need(Modulus::G13)?);
    let ratio = g13 / g12;
    if !(ratio > 0.0 && ratio < 2.0) {
        return Err(EmtError::RatioOutOfRange { ratio });
    }
    Ok(ratio)
}

/// g, where Eq. 10 leaves every contact a positive stiffness.
pub(crate) fn check_eq_10(g: f64) -> Result<f64, EmtError> {
    if g > -1.0 && g < 0.5 {
        return Ok(g);
    }
    Err(EmtError::GammaOutOfRange { g, range: "(-1, 1/2)", law: "Eq. 10" })
}

/// What to say of a shear ratio that contact anisotropy alone cannot give.
pub(crate) fn ratio_warnings(ratio: f64) -> Vec<Warning> {
    let usual = (2.0 / 3.0..=1.5).contains(&ratio);
    if usual { Vec::new() } else { vec![Warning::RatioUnusual { ratio }] }
}

/// What to say of a coordination number in Eqs. 21 and 22 that no packing of the calibration had.
pub(crate) fn outside_fit(quantity: Quantity, value: f64, calibration: &Calibration) -> Option<Warning> {
    let range = calibration.isotropic().fitted;
    let outside = !(range[0]..=range[1]).contains(&value);
    outside.then_some(Warning::CoordinationOutsideFit { quantity, value, range })
}
