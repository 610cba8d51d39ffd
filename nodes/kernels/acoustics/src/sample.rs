//! A packing prepared for a measurement: at rest, with a time step and an estimate of the wave speed.

use crate::backbone::carrying;
use crate::dispersion::mean_diameter;
use crate::error::{AcousticsError, setting};
use grainlab_core::contact::TangentialLaw;
use grainlab_core::{Mat3, Packing, Vec3};
use grainlab_dem::Engine;
use grainlab_engine::{EngineError, EngineSettings, TimeStep};
use grainlab_micromechanics::probe::Relaxation;
use grainlab_micromechanics::unbalanced_force_ratio;

/// Time step over the stability bound; contacts stiffen very little.
const SAFETY: f64 = 0.8;

/// Verlet skin, mean diameters; grains move very little.
const SKIN: f64 = 0.02;

/// Solver steps between two checks of the balance of forces, and maximum number of steps.
const REST_LOOK: u32 = 100;
const REST_STEPS: u32 = 20_000;

/// Unbalanced force ratio below which a packing is at rest: its motion is then far below that of a wave of strain 1e-9,
/// whose forces are 1e-5 of those of overlaps of 1e-4 diameters.
const AT_REST: f64 = 1e-9;

/// A packing at rest.
#[derive(Clone, Debug)]
pub(crate) struct Sample {
    /// Velocities zero, forces in balance.
    pub(crate) packing: Packing,
    /// For each grain, whether it carries force.
    pub(crate) present: Vec<bool>,
    /// The setting of the engine: no damping, fixed time step.
    pub(crate) setting: EngineSettings,
    /// Mean diameter, m.
    pub(crate) diameter: f64,
    /// Unbalanced force ratio, if the packing did not come to rest.
    pub(crate) unbalanced: Option<f64>,
}

impl Sample {
    /// `packing` with `friction` (`None`: that of the packing), relaxed to rest.
    pub(crate) fn new(packing: &Packing, friction: Option<f64>) -> Result<Self, AcousticsError> {
        packing.check().map_err(EngineError::from)?;
        let friction = friction.unwrap_or(packing.friction);
        setting("friction", friction, friction >= 0.0, "0 or more, infinite for no sliding")?;
        let mut packing = Packing { friction, ..packing.clone() };
        let present = carrying(&packing)?;
        packing.velocities.fill(Vec3::zeros());
        packing.spins.fill(Vec3::zeros());
        let diameter = mean_diameter(&packing);
        let setting = EngineSettings {
            friction,
            tangential: TangentialLaw::Incremental,
            time_step: TimeStep::FractionOfStable(SAFETY),
            skin: SKIN * diameter,
            ..EngineSettings::default()
        };
        let mut engine = Engine::from_packing(&packing, setting)?;
        engine.initialise()?;
        engine.update_time_step();
        let setting = EngineSettings { time_step: TimeStep::Fixed(engine.time_step()), ..setting };
        engine.set_settings(setting)?;
        let mut rest = Relaxation::new(vec![engine]);
        let not_at_rest = |rest: &Relaxation| {
            let now = rest.engines[0].packing(Mat3::identity());
            unbalanced_force_ratio(&now, &present).filter(|u| u.is_nan() || *u >= AT_REST)
        };
        for step in 0..REST_STEPS {
            if step % REST_LOOK == 0 && not_at_rest(&rest).is_none() {
                break;
            }
            rest.step()?;
        }
        let unbalanced = not_at_rest(&rest);
        let mut rested = rest.engines[0].packing(packing.deformation);
        rested.velocities.fill(Vec3::zeros());
        rested.spins.fill(Vec3::zeros());
        let present = carrying(&rested)?;
        Ok(Self { packing: rested, present, setting, diameter, unbalanced })
    }

    /// Speed of long waves if every grain moved with the mean deformation, m/s: some tens of per cent above the real
    /// one.
    pub(crate) fn affine_speed(&self, direction: &Vec3, polarization: &Vec3) -> f64 {
        let p = &self.packing;
        let modulus: f64 = p
            .contacts
            .iter()
            .map(|c| {
                let (normal, tangential) = p.contact_stiffness(c);
                let along = c.normal.dot(polarization).powi(2);
                let tangential = if p.friction > 0.0 { tangential } else { 0.0 };
                p.branch(c).dot(direction).powi(2) * (normal * along + tangential * (1.0 - along))
            })
            .sum();
        (modulus / self.mass()).sqrt()
    }

    /// Density of the grains that carry force, kg/m³.
    pub(crate) fn density(&self) -> f64 {
        self.mass() / self.packing.cell.volume()
    }

    /// Mean stress, Pa, positive in compression.
    pub(crate) fn pressure(&self) -> f64 {
        grainlab_core::stress::stress(&self.packing).tensor.mean()
    }

    /// Mass of the grains that carry force, kg.
    fn mass(&self) -> f64 {
        let carried = self.packing.radii.iter().zip(&self.present).filter(|(_, present)| **present);
        carried.map(|(radius, _)| self.packing.material.sphere_mass(*radius)).sum()
    }
}
