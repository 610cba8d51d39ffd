//! Errors of a comparison.

use grainlab_engine::EngineError;

/// Why a comparison could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VerificationError {
    /// The engine ended.
    #[error("the engine: {0}")]
    Engine(#[from] EngineError),
    /// A sphere has no size.
    #[error("a sphere of radius {0:e} m fits into no cell: the reference data are wrong")]
    Cell(f64),
    /// Two spheres did not meet, or did not part.
    #[error("two spheres did not meet and part in {0} steps: the reference data are wrong")]
    NoCollision(u32),
    /// Reference data are not as this program expects them.
    #[error("reference data {file}: {why}")]
    Data {
        /// Name of the file.
        file: &'static str,
        /// Fault of the data.
        why: String,
    },
    /// A packing could not be measured.
    #[error("a measurement of {0}")]
    Measurement(String),
}
