//! What is known of one state.

use super::Args;
use crate::failure::Failure;
use emt::{Gamma, Observation};
use grains::Material;
use serde::Serialize;

/// Poisson ratio of the grains of the paper's calibration, and shear modulus in Pa.
const CALIBRATED: Material = Material::GLASS;

/// One state, as given.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Inputs {
    pub(super) sample: Option<String>,
    pub(super) g12_pa: f64,
    pub(super) g13_pa: f64,
    pub(super) theta_pa: f64,
    /// What the model `ratio-as-printed` takes for Θ, if that is something else.
    pub(super) theta_printed_pa: Option<f64>,
    pub(super) pressure_pa: f64,
    pub(super) gamma_over_delta: Option<f64>,
    pub(super) c11_pa: Option<f64>,
    pub(super) c33_pa: Option<f64>,
    /// What Θ, C11, C33 and G12 leave for C13.
    pub(super) c13_pa: Option<f64>,
    pub(super) grain_shear_modulus_pa: Option<f64>,
    pub(super) poisson: Option<f64>,
    pub(super) phi: Option<f64>,
    pub(super) relative_error: Option<f64>,
}

impl Inputs {
    /// From the command line.
    pub(super) fn of_args(args: &Args) -> Result<Self, Failure> {
        let (Some(g12), Some(g13), Some(theta), Some(pressure)) =
            (args.g12, args.g13, args.theta, args.pressure)
        else {
            return Err(Failure::usage("--g12, --g13, --theta and --pressure are needed, or --table"));
        };
        Self::new(args, [g12, g13, theta, pressure], args.gamma_over_delta)
    }

    /// G12, G13, Θ and the pressure in Pa, with what the command line says of the grains and of the errors.
    pub(super) fn new(
        args: &Args,
        [g12, g13, theta, pressure]: [f64; 4],
        g: Option<f64>,
    ) -> Result<Self, Failure> {
        let positive = |flag: &str, value: Option<f64>| match value {
            Some(v) if !(v > 0.0 && v.is_finite()) => {
                Err(Failure::usage(format!("--{flag} {v} is out of range: more than 0 and finite")))
            }
            other => Ok(other),
        };
        let within = |flag: &str, value: Option<f64>, low: f64, high: f64| match value {
            Some(v) if !(low..=high).contains(&v) => {
                Err(Failure::usage(format!("--{flag} {v} is out of range: {low} to {high}")))
            }
            other => Ok(other),
        };
        let (c11, c33) = (positive("c11", args.c11)?, positive("c33", args.c33)?);
        Ok(Self {
            sample: None,
            g12_pa: g12,
            g13_pa: g13,
            theta_pa: theta,
            theta_printed_pa: None,
            pressure_pa: pressure,
            gamma_over_delta: g,
            c11_pa: c11,
            c33_pa: c33,
            c13_pa: c11.zip(c33).map(|(c11, c33)| (9.0 * theta - 4.0 * c11 + 4.0 * g12 - c33) / 4.0),
            grain_shear_modulus_pa: positive("grain-shear-modulus", args.grain_shear_modulus)?,
            poisson: within("poisson", args.poisson, 0.0, 0.5)?,
            phi: within("phi", args.phi, 0.0, 1.0)?,
            relative_error: within("error", args.error, 0.0, 1.0)?,
        })
    }

    /// As `model` takes it.
    pub(super) fn observation(&self, model: &str) -> Observation {
        let printed = self.theta_printed_pa.filter(|_| model == "ratio-as-printed");
        let theta = printed.unwrap_or(self.theta_pa);
        let gamma = self.gamma_over_delta.map_or(Gamma::ZERO, Gamma::given);
        let observation = Observation::paper(self.g12_pa, self.g13_pa, theta, self.pressure_pa, gamma);
        match self.relative_error {
            Some(relative) => observation.with_relative_error(relative),
            None => observation,
        }
    }

    /// What the models do not see.
    pub(super) fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let (Some(c11), Some(c33), Some(c13)) = (self.c11_pa, self.c33_pa, self.c13_pa)
            && (c11 <= self.g12_pa || c33 * (c11 - self.g12_pa) <= c13 * c13)
        {
            warnings.push(format!(
                "C11, C33, G12 and Theta leave C13 = {c13:.4e} Pa, which no stable medium has: they are not of one state"
            ));
        }
        let differs =
            |given: Option<f64>, reference: f64| given.is_some_and(|v| (v / reference - 1.0).abs() > 1e-6);
        if differs(self.grain_shear_modulus_pa, CALIBRATED.shear_modulus)
            || differs(self.poisson, CALIBRATED.poisson_ratio)
        {
            warnings.push(format!(
                "the calibration is for grains of G = {:.3e} Pa and nu = {}: for others k and k_hat are not to be trusted",
                CALIBRATED.shear_modulus, CALIBRATED.poisson_ratio
            ));
        }
        warnings
    }
}
