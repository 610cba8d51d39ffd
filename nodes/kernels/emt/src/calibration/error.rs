//! Why a calibration is invalid or cannot be learned.

/// Why a calibration is invalid or cannot be learned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// A constant is out of range.
    #[error("{field} = {value} is invalid: {requirement}")]
    Constant {
        /// Name of the constant.
        field: &'static str,
        /// Value of the constant.
        value: f64,
        /// Requirement on the value.
        requirement: &'static str,
    },
    /// The text is not a valid calibration file.
    #[error("{0}")]
    Text(String),
    /// A packing to learn from is none, or its numbers are in other units.
    #[error("packing `{packing}`: {fault}")]
    Packing {
        /// Name of the packing.
        packing: String,
        /// Fault, and what to do.
        fault: String,
    },
    /// The packings are enough, and do not determine a constant.
    #[error("{0}")]
    Undetermined(String),
    /// The packings are too few for the constants.
    #[error("{found} {what}, {needed} or more are needed: prepare more packings, or more different ones")]
    Packings {
        /// The kind of data of which there are too few.
        what: &'static str,
        /// The number found.
        found: usize,
        /// The number needed.
        needed: usize,
    },
}

/// Refuses a constant that is not finite or not `valid`.
pub(super) fn constant(
    field: &'static str,
    value: f64,
    valid: bool,
    requirement: &'static str,
) -> Result<(), CalibrationError> {
    if valid && value.is_finite() {
        return Ok(());
    }
    Err(CalibrationError::Constant { field, value, requirement })
}
