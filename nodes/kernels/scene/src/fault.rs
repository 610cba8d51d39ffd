//! Faults of a scene.

/// One fault of a scene, with its place.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{place}: {message}")]
pub struct Fault {
    /// The place: for example `phase[2] (load).friction`.
    pub place: String,
    /// Fault, and valid values.
    pub message: String,
}

/// All faults of a scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the scene has {}", list(.faults))]
pub struct SceneError {
    /// Every fault found, in the order of the text; at least one.
    pub faults: Vec<Fault>,
}

impl SceneError {
    pub(crate) fn of(faults: Vec<Fault>) -> Result<(), Self> {
        if faults.is_empty() { Ok(()) } else { Err(Self { faults }) }
    }

    pub(crate) fn one(place: &str, message: impl Into<String>) -> Self {
        Self { faults: vec![Fault { place: place.into(), message: message.into() }] }
    }
}

/// Number of faults, and one line for each.
fn list(faults: &[Fault]) -> String {
    let lines: String = faults.iter().map(|fault| format!("\n  {fault}")).collect();
    format!("{} fault{}:{lines}", faults.len(), if faults.len() == 1 { "" } else { "s" })
}
