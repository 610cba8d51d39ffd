//! The ratio model with different normal and tangential stiffness, K_N ≠ K_T, which Eq. 11 takes as equal.
//!
//! Every contact is a spring K_N along its normal and K_T across it, κ = K_N/K_T − 1 = ν/(2(1−ν)): one eighth for
//! glass. Moduli follow from the moments μ_n = ∫₀¹ [(1−ε) + 3εx²] s(x) xⁿ dx, with the stiffness s(x) linear in g (Eq.
//! 10) or not. G13/G12 rises with ε at every κ and g, so that its root in [−1/2, 1] is unique; k̂ and k then follow as
//! in the ratio model. At ν = 0 and with Eq. 10 this is the ratio model; taking K_N as K_T at ν = 0.2 costs 0.004 in an
//! ε of 0.08.

use super::equivalent::{Factors, domain};
use super::shear_ratio::shear_ratio;
use crate::calibration::Calibration;
use crate::conditions::Conditions;
use crate::domain::Domain;
use crate::error::EmtError;
use crate::model::Model;
use crate::moduli::Moduli;
use crate::observation::Observation;
use crate::overlap::{self, Integrals};
use crate::point_estimate::PointEstimate;
use crate::root::bracketed;
use grainlab_core::results::{InferredQuantity, Microstructure};

/// The ratio model with K_N ≠ K_T and one overlap law.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnequalSprings {
    name: &'static str,
    /// Integrals of the stiffness at this g = γ/Δ; an error where some contacts have no stiffness.
    integrals: fn(f64) -> Result<Integrals, EmtError>,
}

/// With the overlap law of Eq. 10: model `full`.
pub(crate) const LINEAR: UnequalSprings = UnequalSprings { name: "full", integrals: overlap::linear };

/// With the overlap law not linear in g: model `sqrt`.
pub(crate) const NONLINEAR: UnequalSprings = UnequalSprings { name: "sqrt", integrals: overlap::nonlinear };

/// Range of ε in which Eq. 6 gives no direction a negative contact density.
const EPS: [f64; 2] = [-0.5, 1.0];

/// Rounding of a G13/G12 at the very ends of [`EPS`].
const SLACK: f64 = 1e-12;

impl Model for UnequalSprings {
    fn name(&self) -> &'static str {
        self.name
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
        conditions.check()?;
        let integrals = (self.integrals)(conditions.gamma.value)?;
        let found = self.domain(calibration).validate(structure, conditions)?;
        let factors =
            factors(&integrals, found[InferredQuantity::Eps as usize], kappa(conditions, calibration));
        Ok(factors.moduli(&found, 1.0, conditions, calibration))
    }

    fn solve(&self, observation: &Observation, calibration: &Calibration) -> Result<PointEstimate, EmtError> {
        let g = observation.conditions.gamma.value;
        let integrals = (self.integrals)(g)?;
        let ratio = shear_ratio(self.name, observation)?;
        let kappa = kappa(&observation.conditions, calibration);
        let excess = |eps: f64| {
            let [_, c44, c66] = springs(&integrals, eps, kappa);
            c44 - ratio * c66
        };
        let wider = [EPS[0] - SLACK, EPS[1] + SLACK];
        let eps = bracketed(excess, wider).ok_or(EmtError::NoAnisotropy { ratio, g })?.clamp(EPS[0], EPS[1]);
        factors(&integrals, eps, kappa).point_estimate(eps, 1.0, observation, calibration)
    }
}

/// K_N/K_T − 1 of the grains.
fn kappa(conditions: &Conditions, calibration: &Calibration) -> f64 {
    let nu = conditions.material.as_ref().unwrap_or(calibration.material()).poisson_ratio;
    nu / (2.0 * (1.0 - nu))
}

/// Moduli of a medium of springs in units of 2 C0 k: 9 Θ/(1+κ), C44 and C66.
fn springs(integrals: &Integrals, eps: f64, kappa: f64) -> [f64; 3] {
    let [mu0, mu2, mu4] = [0, 1, 2].map(|i| (1.0 - eps) * integrals[i] + 3.0 * eps * integrals[i + 1]);
    let (m11, m33) = (0.5 * (mu0 - mu2), mu2);
    let c44 = m11 * m33 / (m11 + m33) + 0.5 * kappa * (mu2 - mu4);
    let c66 = 0.5 * m11 + 0.125 * kappa * (mu0 - 2.0 * mu2 + mu4);
    [mu0, c44, c66]
}

fn factors(integrals: &Integrals, eps: f64, kappa: f64) -> Factors {
    let [bulk, c44, c66] = springs(integrals, eps, kappa);
    let isotropic = 1.0 / 6.0 + kappa / 15.0;
    Factors { g12: c66 / isotropic, g13: c44 / isotropic, bulk }
}
