//! A packing made ready for waves: at rest, with its time step and a first idea of their speed.

use crate::error::AcousticsError;
use grainlab_core::results::NotJammed;
use grainlab_core::{Mat3, Packing, Vec3};
use grainlab_dem::{Engine, Setting, TimeStep};
use grainlab_micromechanics::probe::Relaxation;
use grainlab_micromechanics::{min_contacts, non_rattlers, unbalanced_force_ratio};
use grainlab_scene::Tangential;

/// Share of the stability bound that the time step takes: contacts hardly stiffen.
const SAFETY: f64 = 0.8;

/// Verlet skin, mean diameters: nothing moves.
const SKIN: f64 = 0.02;

/// Solver steps between two looks at the balance of forces, and of all of them.
const REST_LOOK: u32 = 100;
const REST_STEPS: u32 = 20_000;

/// Unbalanced force ratio at which a packing counts as at rest: its own motion is then far below that of a wave of strain
/// 1e-9, whose forces are 1e-5 of those of overlaps of 1e-4 diameters.
const AT_REST: f64 = 1e-9;

/// A packing at rest.
#[derive(Clone, Debug)]
pub(crate) struct Sample {
    /// Velocities zero, forces in balance.
    pub(crate) packing: Packing,
    /// Which grains carry force.
    pub(crate) present: Vec<bool>,
    /// The engine's setting: nothing damps, fixed time step.
    pub(crate) setting: Setting,
    /// Mean diameter, m.
    pub(crate) diameter: f64,
    /// Unbalanced force ratio, where the packing did not come to rest.
    pub(crate) unrest: Option<f64>,
}

impl Sample {
    /// `packing` with `friction` (its own where `None`), come to rest.
    pub(crate) fn new(
        packing: &Packing,
        friction: Option<f64>,
        tangential: Tangential,
    ) -> Result<Self, AcousticsError> {
        let friction = friction.unwrap_or(packing.friction);
        if friction.is_nan() || friction < 0.0 {
            let requirement = "0 or more, infinite for no sliding";
            return Err(AcousticsError::Setting { name: "friction", value: friction, requirement });
        }
        let grains = packing.grains();
        if packing.contacts.is_empty() {
            return Err(NotJammed::NoContacts { grains }.into());
        }
        let mut packing = Packing { friction, ..packing.clone() };
        let present = non_rattlers(&packing);
        if present.iter().all(|p| !p) {
            return Err(NotJammed::OnlyRattlers { grains, needed: min_contacts(friction) }.into());
        }
        packing.velocities.fill(Vec3::zeros());
        packing.spins.fill(Vec3::zeros());
        let diameter = 2.0 * packing.radii.iter().sum::<f64>() / grains as f64;
        let setting = Setting {
            friction,
            damping: 0.0,
            drag: 0.0,
            spin_drag: 0.0,
            tangential,
            time_step: TimeStep::Safety(SAFETY),
            skin: SKIN * diameter,
            speed_cap: None,
        };
        let mut engine = Engine::from_packing(&packing, setting);
        engine.prepare()?;
        engine.renew_time_step();
        let setting = Setting { time_step: TimeStep::Fixed(engine.time_step()), ..setting };
        engine.set(setting);
        let mut rest = Relaxation::new(vec![engine]);
        let unrest = |rest: &Relaxation| {
            let now = rest.engines()[0].packing(Mat3::identity());
            unbalanced_force_ratio(&now, &present).filter(|u| u.is_nan() || *u >= AT_REST)
        };
        for step in 0..REST_STEPS {
            if step % REST_LOOK == 0 && unrest(&rest).is_none() {
                break;
            }
            rest.step()?;
        }
        let unrest = unrest(&rest);
        let mut rested = rest.engines()[0].packing(packing.deformation);
        rested.velocities.fill(Vec3::zeros());
        rested.spins.fill(Vec3::zeros());
        let present = non_rattlers(&rested);
        if present.iter().all(|p| !p) {
            return Err(NotJammed::OnlyRattlers { grains, needed: min_contacts(friction) }.into());
        }
        Ok(Self { packing: rested, present, setting, diameter, unrest })
    }

    /// Speed of long waves if every grain moved with the mean deformation, m/s: above the real one, by some tens of per
    /// cent.
    pub(crate) fn affine_speed(&self, direction: &Vec3, motion: &Vec3) -> f64 {
        let p = &self.packing;
        let modulus: f64 = p
            .contacts
            .iter()
            .map(|c| {
                let (normal, tangential) = p.contact_stiffness(c);
                let along = c.normal.dot(motion).powi(2);
                let tangential = if p.friction > 0.0 { tangential } else { 0.0 };
                p.branch(c).dot(direction).powi(2) * (normal * along + tangential * (1.0 - along))
            })
            .sum();
        (modulus / self.mass()).sqrt()
    }

    /// Mass of each grain, kg; 0 if it carries no force.
    pub(crate) fn masses(&self) -> Vec<f64> {
        let mass = |r: &f64| self.packing.material.sphere_mass(*r);
        self.packing.radii.iter().zip(&self.present).map(|(r, p)| if *p { mass(r) } else { 0.0 }).collect()
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
        self.masses().iter().sum()
    }
}
