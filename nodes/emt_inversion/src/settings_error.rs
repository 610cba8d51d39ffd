//! Why parameters are refused.

use grainlab_emt::CalibrationError;

/// Parameters that are of their type and make no sense. The process then ends with [`grainlab_node_kit::Exit::Usage`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// A model that does not exist.
    #[error("parameter \"models\": no model {name:?}; there are: {known}")]
    Model {
        /// What was given.
        name: String,
        /// The names of all models.
        known: String,
    },
    /// A calibration that does not exist.
    #[error("parameter \"calibration\": no calibration {name:?}; there are: {known}, or a FILE.toml")]
    Calibration {
        /// What was given.
        name: String,
        /// What could have been.
        known: String,
    },
    /// A calibration that cannot be read.
    #[error("parameter \"calibration\": {0}")]
    CalibrationText(CalibrationError),
    /// A file that cannot be read.
    #[error("parameter \"calibration\" = {path:?}: {reason}")]
    CalibrationFile {
        /// The path given.
        path: String,
        /// Why.
        reason: String,
    },
    /// Not an axis.
    #[error(
        "parameter \"axis\" = {0:?} is no axis: stated, e3, found, or three numbers x,y,z that are finite and not all zero"
    )]
    Axis(String),
}
