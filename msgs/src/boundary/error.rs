//! Why messages are refused.

/// Why a message, or the data for one, is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BoundaryError {
    /// A number is not finite or out of its range.
    #[error("{message}.{field} = {value:?} is refused: it must be {requirement}")]
    Value {
        /// Name of the message.
        message: &'static str,
        /// Name of the field, with index or component.
        field: String,
        /// The value found.
        value: f64,
        /// Requirement that is not met.
        requirement: &'static str,
    },
    /// A code that is not one of the constants of the message.
    #[error("{message}.{field} = {value} is refused: it must be one of {allowed}")]
    Code {
        /// Name of the message.
        message: &'static str,
        /// Name of the field, with index or component.
        field: String,
        /// The value found.
        value: u8,
        /// Constants that are allowed.
        allowed: &'static str,
    },
    /// A word that is not one of the allowed ones.
    #[error("{message}.{field} = {value:?} is refused: it must be one of {allowed}")]
    Word {
        /// Name of the message.
        message: &'static str,
        /// Name of the field.
        field: &'static str,
        /// The word found.
        value: String,
        /// The allowed words.
        allowed: &'static str,
    },
    /// The contact law is unknown, or its parameters are invalid.
    #[error("{message}.contact_law is refused: {fault}")]
    ContactLaw {
        /// Name of the message.
        message: &'static str,
        /// Description of the fault.
        fault: grainlab_core::contact::UnknownLaw,
    },
    /// An array of the wrong length.
    #[error("{message}.{field} has {found} entries and is refused: it must have {expected} ({reason})")]
    Length {
        /// Name of the message.
        message: &'static str,
        /// Name of the field.
        field: String,
        /// Number of entries found.
        found: usize,
        /// Number of entries required.
        expected: usize,
        /// The reason for this number.
        reason: &'static str,
    },
    /// The numbers are not a valid packing.
    #[error("Packing is refused: {0}")]
    Packing(#[from] grainlab_core::PackingError),
}
