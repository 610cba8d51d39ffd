//! The simulator node: owns the run, publishes stress and packings, obeys strain rates.
//!
//! - [`parameters`]: what can be set; [`Settings`]: the same, typed
//! - [`DemSimulator`]: the node; `start`: before its first request; `exchange`: after it
//! - `barrier`: the lockstep, one request and its answer; `ahead`: what is computed while the answer is on its way
//! - `outbox`: messages in their order, none lost where a reader is behind
//! - `rivals`: other simulators on the same topics
//! - `messages`: from the run to messages

mod ahead;
mod barrier;
mod exchange;
mod messages;
mod node;
mod outbox;
mod partner;
mod question;
mod rivals;
mod settings;
mod start;

pub use node::{DemSimulator, SimulatorError};
pub use settings::{Mode, Settings, parameters};
