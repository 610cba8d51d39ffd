//! Position of a run on its path, and what was observed there.

use grainlab_core::{Mat3, StrainOrigin, SymTensor};
use grainlab_engine::Observables;
use grainlab_scene::{Observation, PathState, Scene};

/// Everything except the engine that changes as a run advances.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Progress {
    pub(crate) path: PathState,
    pub(crate) sequence: u64,
    pub(crate) packings: u64,
    /// Friction coefficient of the present forces. At the end of a phase the engine already has that of the
    /// next one.
    pub(crate) friction: f64,
    /// Deformation gradient since the reference state; since the first step until a phase sets one.
    pub(crate) deformation: Mat3,
    pub(crate) phase_deformation: Mat3,
    /// Integral over time of the largest component of the strain rate since the phase began.
    pub(crate) phase_strain: f64,
    pub(crate) strain_origin: StrainOrigin,
    /// The present state is within a phase, not at the end of one.
    pub(crate) within_phase: bool,
    pub(crate) observables: Observables,
    pub(crate) solid_fraction: f64,
}

impl Progress {
    pub(crate) fn observation(&self, time: f64) -> Observation {
        Observation {
            time,
            stress: self.observables.stress.tensor,
            strain: SymTensor::logarithmic_strain(&self.phase_deformation),
            solid_fraction: self.solid_fraction,
            unbalanced: self.observables.unbalanced,
            speed: self.observables.speed,
        }
    }
}

/// Solid fraction, by the engine or by the sizes of the grains.
pub(crate) fn solid_fraction(scene: &Scene, seen: &Observables) -> f64 {
    seen.solid_fraction.unwrap_or_else(|| {
        let cubes: f64 = scene.sizes.diameters(scene.grains).iter().map(|d| d * d * d).sum();
        std::f64::consts::PI / 6.0 * cubes / seen.cell.volume()
    })
}
