//! The simulator node: advances the run, publishes stress and packings, applies strain rates.
//!
//! - [`parameters()`]: the parameters of the node; [`Settings`]: their values, typed
//! - [`DemSimulator`]: the node; `start`: before its first request; `exchange`: after it
//! - `lockstep`: one request, its repetitions and its answer; `question`: which answers a request allows
//! - `speculative_step`: computing while the answer is in transit
//! - `send_queue`: messages in order, none lost if a reader is behind
//! - `samples`: some of the requests, for viewers
//! - `duplicate_simulators`: other simulators on the same topics; `partner`: the servo of the run
//! - `inversions`: those of the last packing, awaited before the end; `messages`: messages of the run

mod duplicate_simulators;
mod exchange;
mod inversions;
mod lockstep;
mod messages;
mod node;
mod partner;
mod question;
mod samples;
mod send_queue;
mod settings;
mod speculative_step;
mod start;

pub use node::{DemSimulator, SAVED_WITHIN};
pub use settings::{Settings, parameters};
