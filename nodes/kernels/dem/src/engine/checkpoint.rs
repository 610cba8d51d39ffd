//! A state of the engine to return to.

use crate::domain::state::State;
use crate::pairs::contacts::Contacts;
use crate::pairs::types::SavedContact;
use crate::simd::simd_f64::{F64x4, F64x8};
use grainlab_core::{Cell, Mat3};

/// The part of an engine that cannot be computed from the rest. It has no lists of pairs, no forces, and nothing that never
/// changes.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    step: u64,
    time: f64,
    time_step: f64,
    cell: Cell,
    rate: Mat3,
    position: Vec<F64x4>,
    twist: Vec<F64x8>,
    contacts: Vec<SavedContact>,
}

impl Checkpoint {
    pub(super) fn new(state: &State, contacts: &Contacts) -> Self {
        Self {
            step: state.step,
            time: state.time,
            time_step: state.time_step,
            cell: state.cell,
            rate: state.rate,
            position: state.position.clone(),
            twist: state.twist.clone(),
            contacts: contacts.saved().collect(),
        }
    }

    /// Solver steps done when it was taken.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Number of grains.
    pub(super) fn grains(&self) -> usize {
        self.position.len()
    }

    /// Restores the state, and returns its contacts.
    pub(super) fn restore(self, state: &mut State) -> Contacts {
        (state.step, state.time, state.time_step) = (self.step, self.time, self.time_step);
        (state.cell, state.rate) = (self.cell, self.rate);
        (state.position, state.twist) = (self.position, self.twist);
        let count = self.contacts.len();
        Contacts::from_saved(state, self.contacts.into_iter(), count)
    }
}
