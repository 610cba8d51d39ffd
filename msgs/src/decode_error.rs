//! The error of bytes that are no message of a type.

/// Why bytes are not a valid message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{type_name}: {problem}")]
pub struct DecodeError {
    /// The expected type.
    pub type_name: &'static str,
    /// Description of the fault.
    pub problem: String,
}
