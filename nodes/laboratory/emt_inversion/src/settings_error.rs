//! Why parameters are refused.

use grainlab_emt::CalibrationError;

/// Parameters of the right type with invalid values. The process then ends with
/// [`grainlab_node_kit::Exit::Usage`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// A model that does not exist.
    #[error("parameter \"models\": no model {name:?}; there are: {known}")]
    Model {
        /// The name given.
        name: String,
        /// The names of all models.
        known: String,
    },
    /// A calibration that does not exist.
    #[error("parameter \"calibration\": no calibration {name:?}; there are: {known}, or a FILE.toml")]
    Calibration {
        /// The name given.
        name: String,
        /// The available names.
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
        /// Reason of the failure.
        reason: String,
    },
    /// The text is not an axis.
    #[error(
        "parameter \"axis\" = {0:?} is not an axis: stated, e3, found, or three numbers x,y,z that are finite and not all zero"
    )]
    Axis(String),
}
