//! The models of the inversion, on packings that taught none of them.

use crate::cpu_time::timed;
use crate::numbers::rms;
use crate::row::{Family, Row};
use grainlab_console::Failure;
use grainlab_core::Material;
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{
    Calibration, Conditions, EmtError, Inversion, Measured, Model, Moduli, Observation, StrainRatio,
    StrainRatioSource,
};
use serde::Deserialize;

/// 384 states, with their moduli and their counted structure: see its README.
const HELD_OUT: &str = include_str!("../../golden/ensembles/held_out.csv");

/// The calibration of every model.
const CALIBRATION: &str = "grainlab";

/// One line of the file.
#[derive(Debug, Deserialize)]
struct HeldOut {
    grains: u32,
    phi: f64,
    pressure_pa: f64,
    z: f64,
    eps: f64,
    g_contact: f64,
    g12_pa: f64,
    g13_pa: f64,
    theta_pa: f64,
    ti_c11_pa: f64,
    ti_c33_pa: f64,
    ti_c13_pa: f64,
    grain_shear_modulus_pa: f64,
    poisson: f64,
}

impl HeldOut {
    fn observation(&self) -> Observation {
        let moduli =
            [self.g12_pa, self.g13_pa, self.theta_pa, self.ti_c11_pa, self.ti_c33_pa, self.ti_c13_pa];
        let material = Material {
            shear_modulus: self.grain_shear_modulus_pa,
            poisson_ratio: self.poisson,
            ..Material::GLASS
        };
        let gamma = StrainRatio { value: self.g_contact, stddev: 0.0, source: StrainRatioSource::Contact };
        let conditions = Conditions {
            gamma,
            solid_fraction: Some(Measured::exact(self.phi)),
            stress_ratio: Some(Measured::exact(0.0)),
            size_spread: Some(0.0),
            material: Some(material),
            ..Conditions::at(self.pressure_pa)
        };
        let observation = Observation::new(Moduli::of_values(moduli.map(Some)), conditions);
        Observation { grains: Some(self.grains), ..observation }
    }
}

/// A row for each model and each quantity that it infers.
pub(super) fn rows(passes: u32) -> Result<Vec<Row>, Failure> {
    let states = states()?;
    let calibration = Calibration::builtin(CALIBRATION)
        .ok_or_else(|| Failure::failed(format!("no calibration {CALIBRATION} in this program")))?;
    let mut rows = Vec::new();
    for model in grainlab_emt::models() {
        rows.extend(of(*model, &states, calibration, passes)?);
    }
    Ok(rows)
}

fn states() -> Result<Vec<HeldOut>, Failure> {
    let failed = |e| Failure::failed(format!("held-out states in this program: {e}"));
    csv::Reader::from_reader(HELD_OUT.as_bytes()).deserialize().collect::<Result<_, _>>().map_err(failed)
}

fn of(
    model: &dyn Model,
    states: &[HeldOut],
    calibration: &Calibration,
    passes: u32,
) -> Result<Vec<Row>, Failure> {
    let observations: Vec<Observation> = states.iter().map(HeldOut::observation).collect();
    let all = || Ok(observations.iter().map(|o| model.infer(o, calibration)).collect());
    let (seconds, found): (f64, Result<Vec<Result<Inversion, EmtError>>, Failure>) = timed(passes, all)?;
    let found = found?;
    let quantity = |family: Family, quantity: InferredQuantity, truth: fn(&HeldOut) -> f64| {
        let error = |(state, found): (&HeldOut, &Result<Inversion, EmtError>)| {
            Some(found.as_ref().ok()?.structure.get(quantity)? - truth(state))
        };
        let errors: Vec<f64> = states.iter().zip(&found).filter_map(error).collect();
        let (known, all) = (errors.len(), states.len());
        let setting = if known == all { String::new() } else { format!("{known} of {all}") };
        let time = (seconds / all as f64, passes as usize);
        let reference = "counted in 384 states of packings that no model was learned from";
        let error = Some(rms(&errors)).filter(|rms| rms.is_finite())?;
        Some(Row::new(family, (model.name(), setting), time, (Some(error), reference)))
    };
    let eps = quantity(Family::InversionEps, InferredQuantity::Eps, |s| s.eps);
    let z = quantity(Family::InversionZ, InferredQuantity::Z, |s| s.z);
    Ok(eps.into_iter().chain(z).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_states_of_this_program_are_the_384_held_out_ones() {
        let states = states().unwrap();
        assert_eq!(states.len(), 384);
        assert!(states.iter().all(|s| s.grains == 2000 && s.z > 4.0 && s.g12_pa > 0.0));
    }

    #[test]
    fn the_relaxed_model_infers_both_quantities_of_every_state_and_needs_no_strain_ratio() {
        let (states, calibration) = (states().unwrap(), Calibration::builtin(CALIBRATION).unwrap());
        let rows = of(grainlab_emt::model("relaxed").unwrap(), &states[..40], calibration, 1).unwrap();
        assert_eq!(
            rows.iter().map(|r| r.family).collect::<Vec<_>>(),
            [Family::InversionEps, Family::InversionZ]
        );
        let small = |r: &Row| r.error.is_some_and(|e| e > 0.0 && e < 0.1);
        assert!(rows.iter().all(|r| r.setting.is_empty() && small(r)), "{rows:?}");
    }
}
