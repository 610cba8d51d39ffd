//! Anisotropy by stress alone: contacts in all directions alike, stiffer along the larger stress.
//!
//! Johnson et al., J. Appl. Mech. 65, 380 (1998). The stress ratio q/p gives the shape of the strain, by a root that is
//! unique, Θ then gives k. ε is not inferred: the model takes it as 0. ε weighted by contact stiffness follows from q/p.
//! At isotropic stress this is Hertz–Mindlin without slip.
//!
//! Without slip the stress depends on the path of strain, here first along all axes, then along e3. [`crate::PackShape`] also has
//! the stress after slip.

use super::equivalent::MAX_COORDINATION;
use super::uniform_strain::own_error;
use crate::calibration::Calibration;
use crate::conditions::Conditions;
use crate::domain::Domain;
use crate::error::EmtError;
use crate::model::Model;
use crate::moduli::{Moduli, Modulus};
use crate::observation::Observation;
use crate::point_estimate::PointEstimate;
use crate::root::bracketed;
use crate::sphere_pack::{ContactHistory, PackShape, mindlin};
use crate::warning::Warning;
use grainlab_core::Material;
use grainlab_core::results::{InferredQuantity, Microstructure};

/// The pack under unequal strain, without slip: model `johnson`. It uses only the material of the calibration, where that of the
/// grains is not known.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Johnson;

const NAME: &str = "johnson";

const HISTORY: ContactHistory = ContactHistory::HydrostaticFirst;

/// Range of g in which every contact is closed.
const SHAPES: [f64; 2] = [-0.5, 0.25];

/// Range of q/p that closed contacts carry for every Poisson's ratio: −3/4 and 3/2 at the ends of [`SHAPES`] with slip,
/// and more without.
const STRESS_RATIOS: [f64; 2] = [-0.74, 1.49];

impl Model for Johnson {
    fn name(&self) -> &'static str {
        NAME
    }

    fn uses_gamma(&self) -> bool {
        false
    }

    fn uses_constants(&self) -> bool {
        false
    }

    fn domain(&self, _: &Calibration) -> Domain {
        let mut structure = [None; InferredQuantity::COUNT];
        structure[InferredQuantity::K as usize] = Some([0.1, MAX_COORDINATION]);
        let domain = Domain::new(NAME, structure);
        Domain { needs_solid_fraction: true, stress_ratio: STRESS_RATIOS, ..domain }
    }

    fn predict(
        &self,
        structure: &Microstructure,
        conditions: &Conditions,
        calibration: &Calibration,
    ) -> Result<Moduli, EmtError> {
        let found = self.domain(calibration).validate(structure, conditions)?;
        let material = conditions.material.unwrap_or(*calibration.material());
        let phi = conditions.solid_fraction.map_or(f64::NAN, |phi| phi.value);
        let shape = shape(conditions, &material)?;
        let unit = shape.unit(found[InferredQuantity::K as usize], phi, &material, conditions.pressure.value);
        let moduli = Moduli::of_medium(&shape.stiffness()).values();
        Ok(Moduli::of_values(moduli.map(|m| m.map(|m| m * unit))))
    }

    fn solve(&self, observation: &Observation, calibration: &Calibration) -> Result<PointEstimate, EmtError> {
        let conditions = &observation.conditions;
        let missing = EmtError::Missing { model: NAME, missing: "the solid fraction" };
        let phi = conditions.solid_fraction.ok_or(missing)?.value;
        let theta = observation.moduli.get(Modulus::Theta).ok_or(EmtError::missing(NAME, Modulus::Theta))?;
        let material = conditions.material.unwrap_or(*calibration.material());
        let shape = shape(conditions, &material)?;
        let dimensionless = Moduli::of_medium(&shape.stiffness()).get(Modulus::Theta);
        let unit = theta / dimensionless.unwrap_or(f64::NAN);
        let k = shape.coordination(unit, phi, &material, observation.pressure());
        let mut warnings = vec![Warning::IsotropicContacts];
        if conditions.stress_ratio.is_none() {
            warnings.push(Warning::StressRatioUnknown);
        }
        let structure = Microstructure::default()
            .with(InferredQuantity::K, k)
            .with(InferredQuantity::EpsStiffness, shape.eps_stiffness());
        let discrepancy = Some(own_error(&structure));
        Ok(PointEstimate { warnings, discrepancy, ..PointEstimate::exact(structure) })
    }
}

/// The shape of the strain that has the stress ratio of `conditions`.
fn shape(conditions: &Conditions, material: &Material) -> Result<PackShape, EmtError> {
    let ratio = conditions.stress_ratio.map_or(0.0, |ratio| ratio.value);
    let stiffness_ratio = mindlin(material);
    let excess =
        |g: f64| PackShape::new(g, stiffness_ratio).map_or(f64::NAN, |s| s.stress_ratio(HISTORY) - ratio);
    let [low, high] = STRESS_RATIOS;
    let g = bracketed(excess, SHAPES).filter(|_| (low..=high).contains(&ratio));
    let outside = EmtError::OutsideDomain { model: NAME, quantity: "q/p", value: ratio, low, high };
    PackShape::new(g.ok_or(outside)?, stiffness_ratio)
}
