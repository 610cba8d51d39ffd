//! Errors in the name of this engine.

use grainlab_engine::EngineError;

/// Name of the engine, in a launch and in recordings.
pub const NAME: &str = "lammps";

/// Error for input that LAMMPS does not take, and for a state that it cannot go on from.
pub(crate) fn refused<T>(reason: impl Into<String>) -> Result<T, EngineError> {
    Err(EngineError::Failed { engine: NAME.into(), reason: reason.into() })
}
