//! Errors of a run.

use grainlab_dem::DemError;

/// Why a run cannot start or continue.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExperimentError {
    /// The engine failed.
    #[error(transparent)]
    Engine(#[from] DemError),
    /// Another engine failed.
    #[error("{engine}: {reason}")]
    OtherEngine {
        /// Name of the engine.
        engine: String,
        /// Why, and what to do.
        reason: String,
    },
    /// The program of another engine ended, or does not answer. A new one can go on from the last packing.
    #[error("{engine}: {reason}")]
    EngineLost {
        /// Name of the engine.
        engine: String,
        /// Fault, with the last lines of the program.
        reason: String,
    },
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
    /// True if the run was stopped by the flag of its compute settings, and can go on.
    pub fn is_stopped(&self) -> bool {
        matches!(self, Self::Engine(DemError::Stopped))
    }
}
