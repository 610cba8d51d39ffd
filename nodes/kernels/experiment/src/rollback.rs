//! The state that a failing run returns to.

use grainlab_core::Mat3;
use grainlab_dem::{Checkpoint, Observables};
use grainlab_scene::PathState;

/// Everything that changes as a run advances.
#[derive(Clone, Debug)]
pub(crate) struct Rollback {
    pub(crate) engine: Checkpoint,
    pub(crate) path: PathState,
    pub(crate) sequence: u64,
    pub(crate) friction: f64,
    pub(crate) deformation: Mat3,
    pub(crate) phase_deformation: Mat3,
    pub(crate) phase_strain: f64,
    pub(crate) within_phase: bool,
    pub(crate) observables: Observables,
}
