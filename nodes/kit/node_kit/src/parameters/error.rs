//! Errors of parameters.

/// Why a parameter or a parameter file is refused. The process then ends with [`crate::Exit::Usage`].
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct ParameterError(pub(super) String);
