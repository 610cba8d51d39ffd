//! Why messages are refused.

/// Why a message, or the data for one, is refused: the field with its message, what was found, and what it must be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct BoundaryError(pub(super) String);

impl From<grainlab_core::PackingError> for BoundaryError {
    fn from(error: grainlab_core::PackingError) -> Self {
        Self(format!("Packing is refused: {error}"))
    }
}
