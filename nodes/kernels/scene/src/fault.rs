//! Faults of a scene.

use std::fmt;

/// One fault of a scene, with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The place: for example `phase[2] (load).friction`.
    pub place: String,
    /// Fault, and valid values.
    pub message: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)
    }
}

/// All faults of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    /// Every fault found, in the order of the text; at least one.
    pub faults: Vec<Fault>,
}

impl SceneError {
    /// An error unless there are no faults.
    pub(crate) fn of(faults: Vec<Fault>) -> Result<(), Self> {
        if faults.is_empty() { Ok(()) } else { Err(Self { faults }) }
    }

    /// A single fault.
    pub(crate) fn one(place: &str, message: impl Into<String>) -> Self {
        Self { faults: vec![Fault { place: place.into(), message: message.into() }] }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let n = self.faults.len();
        write!(f, "the scene has {n} fault{}:", if n == 1 { "" } else { "s" })?;
        for fault in &self.faults {
            write!(f, "\n  {fault}")?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {}
