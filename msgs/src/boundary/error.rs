//! Why messages are refused.

/// Why a message, or what should become one, is refused.
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
        /// What is required.
        requirement: &'static str,
    },
    /// A code that is none of the message's constants.
    #[error("{message}.{field} = {value} is refused: it must be one of {allowed}")]
    Code {
        /// Name of the message.
        message: &'static str,
        /// Name of the field, with index or component.
        field: String,
        /// The value found.
        value: u8,
        /// The constants.
        allowed: &'static str,
    },
    /// A word that is none of those agreed on.
    #[error("{message}.{field} = {value:?} is refused: it must be one of {allowed}")]
    Word {
        /// Name of the message.
        message: &'static str,
        /// Name of the field.
        field: &'static str,
        /// The word found.
        value: String,
        /// Those agreed on.
        allowed: &'static str,
    },
    /// The contact law is unknown, or its parameters are invalid.
    #[error("Packing.contact_law is refused: {0}")]
    ContactLaw(#[from] grainlab_core::contact::UnknownLaw),
    /// An array of the wrong length.
    #[error("{message}.{field} has {found} entries and is refused: it must have {expected} ({reason})")]
    Length {
        /// Name of the message.
        message: &'static str,
        /// Name of the field.
        field: String,
        /// Entries it has.
        found: usize,
        /// Entries it must have.
        expected: usize,
        /// Why.
        reason: &'static str,
    },
    /// Numbers that make no packing.
    #[error("Packing is refused: {0}")]
    Packing(#[from] grainlab_core::PackingError),
}
