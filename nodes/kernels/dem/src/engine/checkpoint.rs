//! A state of the engine to return to.

use crate::domain::state::State;
use crate::pairs::types::SavedContact;

/// The part of an engine that cannot be computed from the rest. It has no lists of pairs and no forces.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    pub(super) state: State,
    pub(super) contacts: Vec<SavedContact>,
}

impl Checkpoint {
    /// Solver steps done when it was taken.
    pub fn step(&self) -> u64 {
        self.state.step
    }
}
