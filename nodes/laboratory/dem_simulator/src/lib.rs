//! The simulator node: advances the run, publishes stress and packings, applies strain rates.
//!
//! - [`parameters()`]: the parameters of the node; [`Settings`]: their values, typed
//! - [`DemSimulator`]: the node; `node/start`: before its first request; `node/exchange`: after it; `node/end`: after the path
//! - `run`: the simulation, and the time that it takes; `speculative_step`: computing while the answer is in transit
//! - `servo`: requests and answers; `lockstep`: one request, its repetitions and its answer; `partner`: which servo answers
//! - `publication`: all other messages; `send_queue`: messages in order, none lost if a reader is behind
//! - `samples`: some of the requests, for viewers; `messages`: messages of the run
//! - `duplicate_simulators`: other simulators on the same topics
//! - `results`: data and answers as they arrive; `run_end`: what the end of the run waits for

mod duplicate_simulators;
mod lockstep;
mod messages;
mod node;
mod partner;
mod publication;
mod results;
mod run;
mod run_end;
mod samples;
mod send_queue;
mod servo;
mod settings;
mod speculative_step;

pub use node::DemSimulator;
pub use publication::SAVED_WITHIN;
pub use run_end::RecordedSpeeds;
pub use settings::{Finish, Settings, parameters};
