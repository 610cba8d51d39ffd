//! Errors of a run.

use grainlab_dem::gas::GasError;
use grainlab_engine::EngineError;

/// Why a run cannot start or continue.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExperimentError {
    /// The engine failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The gas that a run begins with failed.
    #[error(transparent)]
    Gas(#[from] GasError),
    /// A servo cannot answer a request.
    #[error(transparent)]
    Servo(#[from] grainlab_servo::ServoError),
    /// The path failed.
    #[error(transparent)]
    Path(#[from] grainlab_scene::PathError),
    /// A saved state does not belong to this scene or version.
    #[error("cannot resume: {0}")]
    Resume(String),
}

impl ExperimentError {
    /// True if the program of another engine is gone, so that there is no state to save.
    pub fn is_lost(&self) -> bool {
        matches!(self, Self::Engine(EngineError::Lost { .. }))
    }

    /// True if the run was stopped by the flag of its compute settings, and can go on.
    pub fn is_stopped(&self) -> bool {
        matches!(self, Self::Engine(EngineError::Stopped) | Self::Gas(GasError::Stopped))
    }
}
