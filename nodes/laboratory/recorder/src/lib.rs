//! The recorder node: every sample of every topic into one recording, and the player of recordings.
//!
//! - [`Settings`], [`parameters()`]: what is recorded, and where to
//! - `binding`: the messages of a run by hand; [`repeats`]: repetitions of recorded messages
//! - `disputes`: processes that contradict each other, packings of another scene
//! - [`strangers`]: processes on the bus that are not part of the run
//! - [`OtherTopics`]: topics of other programs, found on the bus
//! - [`Recorder`]: the node; [`ResultSlot`]: the finished recording
//! - [`play`]: publishes the messages of a recording again
//! - [`tallies`]: losses, and the table of counts

mod binding;
mod discovery;
mod disputes;
mod known_processes;
mod node;
pub mod play;
pub mod repeats;
mod settings;
pub mod strangers;
pub mod tallies;

pub use discovery::OtherTopics;
pub use node::{Recorder, ResultSlot};
pub use settings::{Settings, contract_topics, parameters, set_parameter};
