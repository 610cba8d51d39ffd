//! Explicit probe: stiffness from the stress change under a small strain, with the whole contact law.
//!
//! Each of the six strains is imposed homogeneously, forward and backward. Its affine velocity enters the
//! tangential springs (also across periodic images); the grains relax in the strained cell; a column of C is
//! the stress difference over the strain difference, dσ = −C : dE. Nothing is linearised, so that the probe
//! includes what [`crate::network::relaxed_stiffness()`] leaves out: contacts that open or close, and terms
//! of the order of the pressure. The stress is Cauchy's, in the present volume, and the strain is logarithmic
//! and without rotation. For an isotropic stress the affine part of C11, C12 and C44 therefore differs from
//! that of the frozen network by −0.4 p, +1.2 p and −0.8 p (Barron & Klein, Proc. Phys. Soc. 85, 523 (1965),
//! with the geometric part of isotropic contacts), and C is symmetric only to the order of the deviatoric
//! stress. The strained boxes of LAMMPS measure the same quantity, except for the rotation in simple shear
//! (again of the order of the deviatoric stress).

use super::column::{ProbeColumn, RestState, STEPS_PER_EVALUATION, strained};
use super::relaxation::Relaxation;
use super::settings::StrainProbe;
use crate::error::ProbeError;
use grainlab_core::contact::TangentialLaw;
use grainlab_core::results::NoStiffness;
use grainlab_core::{Packing, Stiffness, Vec3, backbone, min_contacts};
use grainlab_dem::Engine;
use grainlab_engine::{EngineSettings, TimeStep};

/// Before it is strained, the packing is relaxed to this fraction of the unbalanced force that ends a
/// relaxation afterwards.
const REST: f64 = 0.25;

/// Verlet skin, fraction of the smallest diameter: the grains hardly move.
const SKIN: f64 = 0.01;

/// The result of [`strain_probe`].
#[derive(Clone, Debug, PartialEq)]
pub struct StrainProbeResult {
    /// The measured stiffness, not symmetrised.
    pub stiffness: Stiffness,
    /// The probe was without friction, and so without tangential springs.
    pub smooth: bool,
    /// Largest |C_ab − C_ba| over the largest entry of C.
    pub asymmetry: f64,
    /// Steps that brought the packing to rest before it was strained.
    pub rest_steps: u32,
    /// Details of each column, Voigt order.
    pub columns: [ProbeColumn; 6],
}

impl StrainProbeResult {
    /// Standard error of each entry, Pa: the largest of the residual of the relaxation, the difference
    /// between forward and backward strain, and the difference between the entry and its transposed one.
    pub fn stddev(&self) -> Stiffness {
        let c = &self.stiffness.0;
        let mut stddev = nalgebra::Matrix6::zeros();
        for (b, column) in self.columns.iter().enumerate() {
            let left = column.residual.max(column.drift).max(0.5 * column.forward_backward);
            for a in 0..6 {
                stddev[(a, b)] = (left * c.column(b).amax()).max(0.5 * (c[(a, b)] - c[(b, a)]).abs());
            }
        }
        Stiffness(stddev)
    }

    /// Largest standard error over the largest entry of the stiffness.
    pub fn relative_error(&self) -> f64 {
        self.stddev().0.amax() / self.stiffness.0.amax()
    }

    /// Largest residual of the columns.
    pub fn residual(&self) -> f64 {
        self.columns.iter().map(|c| c.residual).fold(0.0, f64::max)
    }

    /// Solver steps, including the first relaxation.
    pub fn steps(&self) -> u32 {
        self.rest_steps + self.sum(|c| c.steps)
    }

    /// Sum of `part` over the columns.
    pub fn sum(&self, part: fn(&ProbeColumn) -> u32) -> u32 {
        self.columns.iter().map(part).sum()
    }

    /// Largest difference between the forward and the backward column, relative to the largest entry.
    pub fn forward_backward(&self) -> f64 {
        self.columns.iter().map(|c| c.forward_backward).fold(0.0, f64::max)
    }
}

/// Measures the stiffness of `packing` by straining it, all six columns.
///
/// The packing is first relaxed from rest with the friction of the probe. The strained copies relax in
/// parallel, so that the remaining error cancels. All contacts keep their forces.
pub fn strain_probe(packing: &Packing, settings: &StrainProbe) -> Result<StrainProbeResult, ProbeError> {
    settings.check()?;
    let load = strain_load(packing, settings)?;
    let (rest, rest_steps) = relaxed(packing, settings, load)?;
    let at_rest = RestState::new(rest)?;
    let mut stiffness = nalgebra::Matrix6::zeros();
    let mut columns = [ProbeColumn::default(); 6];
    for (c, column) in columns.iter_mut().enumerate() {
        let entries;
        (entries, *column) = strained(&at_rest, settings, load, c)?;
        stiffness.set_column(c, &entries.into());
    }
    let asymmetry = (stiffness - stiffness.transpose()).amax() / stiffness.amax();
    let smooth = settings.friction_of(packing) == 0.0;
    Ok(StrainProbeResult { stiffness: Stiffness(stiffness), smooth, asymmetry, rest_steps, columns })
}

/// Mean change of a contact force by the affine strain, over the mean contact force.
fn strain_load(packing: &Packing, settings: &StrainProbe) -> Result<f64, ProbeError> {
    let grains = packing.grains();
    if packing.contacts.is_empty() {
        return Err(NoStiffness::NoContacts { grains }.into());
    }
    let friction = settings.friction_of(packing);
    let needed = min_contacts(friction);
    let contacts = packing.contacts.iter().map(|c| [c.i, c.j]).collect();
    if backbone(grains, contacts, needed).iter().all(|p| !p) {
        return Err(NoStiffness::OnlyRattlers { grains, needed }.into());
    }
    let (mut change, mut force) = (0.0, 0.0);
    for c in &packing.contacts {
        change += settings.amplitude * packing.contact_stiffness(c).0 * packing.branch(c).norm();
        force += packing.law.normal_force(&packing.material, packing.effective_radius(c), c.overlap);
    }
    Ok(change / force)
}

/// An engine with the relaxed packing, and the number of steps.
fn relaxed(packing: &Packing, settings: &StrainProbe, load: f64) -> Result<(Engine, u32), ProbeError> {
    let smallest = packing.radii.iter().copied().fold(f64::INFINITY, f64::min);
    let setting = EngineSettings {
        friction: settings.friction_of(packing),
        // The frozen network is its linear limit; the other law depends on the direction of the strain, however small.
        tangential: TangentialLaw::Incremental,
        time_step: TimeStep::FractionOfStable(1.0),
        skin: SKIN * 2.0 * smallest,
        ..EngineSettings::default()
    };
    let still = vec![Vec3::zeros(); packing.grains()];
    // Without its own time step, the engine takes the longest stable one.
    let mut engine = Engine::from_packing(&Packing { time_step: 0.0, ..packing.clone() }, setting)?;
    engine.set_settings(setting)?;
    engine.set_velocities(&still)?;
    engine.set_spins(&still)?;
    engine.initialise()?;
    engine.set_settings(EngineSettings { time_step: TimeStep::Fixed(engine.time_step()), ..setting })?;
    let target = REST * settings.tolerance * load;
    let mut unbalanced = engine.observables()?.unbalanced;
    let mut relaxation = Relaxation::new(vec![engine]);
    let mut steps = 0;
    // At least once: the first step projects tangential forces of another program on the contact plane.
    while steps == 0 || unbalanced > target {
        if steps >= settings.max_steps {
            return Err(ProbeError::NoRest { unbalanced, target, steps });
        }
        for _ in 0..STEPS_PER_EVALUATION {
            relaxation.step()?;
        }
        steps += STEPS_PER_EVALUATION;
        unbalanced = relaxation.engines[0].observables()?.unbalanced;
    }
    let mut engine = relaxation.engines[0].clone();
    engine.set_velocities(&still)?;
    engine.set_spins(&still)?;
    Ok((engine, steps))
}
