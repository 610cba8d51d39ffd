//! The recorder node: every sample of every topic into one recording.
//!
//! - [`Settings`], [`parameters`]: what is recorded, and where to
//! - `binding`: whose messages belong to a run by hand; [`repeats`]: messages that say what was recorded already
//! - [`strangers`]: who was on the bus beside the run, and who wrote which result
//! - [`Recorder`]: the node; [`ResultSlot`]: where it leaves what it finished
//! - [`tallies`]: what was lost, and the counts for people

mod binding;
mod node;
pub mod repeats;
mod settings;
pub mod strangers;
pub mod tallies;

pub use node::{Recorder, ResultSlot};
pub use settings::{Settings, contract_topics, parameters};
