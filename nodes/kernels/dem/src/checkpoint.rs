//! The part of an engine that cannot be found again, to go back to.

use crate::contacts::{Contacts, Kept};
use crate::lanes::{Octad, Quad};
use crate::state::State;
use grainlab_core::{Cell, Mat3};

/// A state to go back to: no lists, no forces, nothing that never changes.
#[derive(Clone, Debug)]
pub(crate) struct Checkpoint {
    step: u64,
    time: f64,
    time_step: f64,
    cell: Cell,
    rate: Mat3,
    position: Vec<Quad>,
    twist: Vec<Octad>,
    touching: Vec<Kept>,
}

impl Checkpoint {
    pub(crate) fn of(state: &State, contacts: &Contacts) -> Self {
        Self {
            step: state.step,
            time: state.time,
            time_step: state.time_step,
            cell: state.cell,
            rate: state.rate,
            position: state.position.clone(),
            twist: state.twist.clone(),
            touching: contacts.kept().collect(),
        }
    }

    pub(crate) fn step(&self) -> u64 {
        self.step
    }

    /// Puts the state back, and gives its contacts.
    pub(crate) fn restore(self, state: &mut State) -> Contacts {
        (state.step, state.time, state.time_step) = (self.step, self.time, self.time_step);
        (state.cell, state.rate) = (self.cell, self.rate);
        (state.position, state.twist) = (self.position, self.twist);
        let count = self.touching.len();
        Contacts::of(state, self.touching.into_iter(), count)
    }
}
