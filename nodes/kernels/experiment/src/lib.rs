//! A scene run along its loading path, one request to the servo and one strain rate at a time.
//!
//! - [`Simulation`]: the run
//! - [`ServoRequest`], [`StepOutcome`]: its requests, and the results of a strain rate
//!
//! A packing and the run state published with it are a checkpoint: a run resumed from them continues bit for
//! bit.

mod error;
mod left_out;
mod phase_settings;
mod request;
mod rollback;
mod run_state;
mod simulation;

pub use error::ExperimentError;
pub use request::{ServoRequest, StepOutcome};
pub use run_state::{PathPosition, StrainOrigin};
pub use simulation::Simulation;
