//! A scene run along its loading path, one request to the servo and one strain rate at a time.
//!
//! - [`Simulation`]: the run
//! - [`StepOutcome`]: the result of one strain rate
//!
//! A packing and the run state published with it are a checkpoint: a run resumed from them continues bit for
//! bit.

mod error;
mod gas;
mod phase_settings;
mod progress;
mod run_state;
mod simulation;

pub use error::ExperimentError;
pub use simulation::{Simulation, StepOutcome};
