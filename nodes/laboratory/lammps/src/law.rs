//! The contact law as commands, and parts of a scene that LAMMPS does not have.

use crate::refusal::refused;
use grainlab_core::Material;
use grainlab_core::contact::{ContactLaw, SpringLaw, TangentialLaw};
use grainlab_engine::{EngineError, EngineSettings};
use grainlab_scene::{GasMethod, PhaseKind, Scene};
use std::f64::consts::PI;

/// Friction coefficient at which no contact slides.
pub(crate) const MOST_FRICTION: f64 = 1e4;

/// Refuses a scene with a part that LAMMPS does not have.
///
/// # Errors
/// The part, by its key or its phase.
pub fn check_scene(scene: &Scene) -> Result<(), EngineError> {
    check_law(&scene.law)?;
    if scene.numerics.energy_balance {
        return refused("numerics.energy_balance: LAMMPS has no balance of the energy of contacts");
    }
    for phase in &scene.phases {
        let place = format!("phase {}: ", phase.name);
        match phase.kind {
            PhaseKind::Gas { method: GasMethod::EventDriven, .. } => {}
            PhaseKind::Gas { .. } => {
                return refused(
                    place + "a gas of soft grains; the gas before LAMMPS is method = \"event_driven\"",
                );
            }
            _ => check(&place, phase.friction, phase.damping)?,
        }
    }
    Ok(())
}

/// Refuses a contact law other than Hertz and Mindlin.
pub(crate) fn check_law(law: &ContactLaw) -> Result<(), EngineError> {
    if law.rolling.is_some() {
        return refused(
            "resistance to rolling: its force is not that of LAMMPS; only hertz_mindlin without it",
        );
    }
    if law.springs != SpringLaw::default() {
        return refused(format!("contact law {}; only hertz_mindlin", law.name()));
    }
    Ok(())
}

pub(crate) fn check_settings(settings: &EngineSettings) -> Result<(), EngineError> {
    let EngineSettings { friction, damping, drag, spin_drag, skin, .. } = *settings;
    for (name, value) in [("drag", drag), ("spin_drag", spin_drag), ("skin", skin)] {
        if !(value >= 0.0 && value.is_finite()) {
            return refused(format!("{name} is {value:e}; it must be 0 or more"));
        }
    }
    if settings.thermostat_speed.is_some() {
        return refused("a thermostat; the gas before LAMMPS is that of grainlab");
    }
    check("", friction, damping)
}

fn check(place: &str, friction: f64, damping: f64) -> Result<(), EngineError> {
    if !(0.0..=MOST_FRICTION).contains(&friction) {
        return refused(format!("{place}friction {friction}: 0 to 10000; without sliding, take 10000"));
    }
    restitution(place, damping).map(drop)
}

/// The coefficient of restitution that gives LAMMPS the dashpot of ours with this fraction of critical damping.
///
/// `coeff_restitution` has c = √5 s √(m F/δ) with s = −ln e/√(π² + ln² e), and F/δ = (2/3) k_n of Hertz; ours is
/// c = 2 ζ √(m k_n). So s = 2 ζ √(3/10).
fn restitution(place: &str, damping: f64) -> Result<f64, EngineError> {
    let s = 2.0 * damping * 0.3f64.sqrt();
    if !(0.0..0.999).contains(&s) {
        return refused(format!("{place}damping {damping}: 0 to 0.911, where the restitution falls to 0"));
    }
    Ok((-PI * s / (1.0 - s * s).sqrt()).exp())
}

pub(crate) fn pair_coeff(material: &Material, settings: &EngineSettings) -> Result<String, EngineError> {
    let young = 2.0 * material.shear_modulus * (1.0 + material.poisson_ratio);
    let restitution = restitution("", settings.damping)?;
    let dashpot_ratio = material.stiffness_ratio().sqrt();
    let tangential = match (settings.friction, settings.tangential) {
        (0.0, _) => "linear_nohistory 0 0".to_owned(),
        (friction, law) => {
            let law = match law {
                TangentialLaw::Rescaled => "mindlin_rescale/force",
                TangentialLaw::Incremental => "mindlin/force",
            };
            format!("{law} NULL {dashpot_ratio:e} {friction:e}")
        }
    };
    let poisson = material.poisson_ratio;
    Ok(format!(
        "hertz/material {young:e} {restitution:e} {poisson:e} tangential {tangential} damping coeff_restitution limit_damping"
    ))
}
