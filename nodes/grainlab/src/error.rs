//! Errors, by what the caller asked for. Each text has the fault, its place, and what to do.

/// The reason why there is no result.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A scene has faults, or does not exist.
    #[error("{0}")]
    Scene(String),
    /// A run cannot go on: it is unstable, or a phase does not reach its end.
    #[error("{0}")]
    Simulation(String),
    /// A packing contradicts itself, or its stiffness cannot be solved for.
    #[error("{0}")]
    Measurement(String),
    /// Data that no model can invert.
    #[error("{0}")]
    Inversion(String),
    /// A file cannot be read, or is not what it should be.
    #[error("{0}")]
    File(String),
}
