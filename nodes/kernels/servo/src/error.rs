//! Why a request or an answer is invalid.

/// Why a request or its answer is invalid, with the value and the valid ones.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ServoError(pub(crate) String);
