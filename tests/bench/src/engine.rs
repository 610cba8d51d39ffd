//! Cost and error of the settings of the engine: the energy that a time step creates, and the packings that settings lead to.
//!
//! - `settings`: the settings that are varied; `run`: runs of a scene at several seeds
//! - `energy`, `packings`: their rows; `statistics`: differences over seeds

mod energy;
mod packings;
mod run;
mod settings;
mod statistics;

pub(crate) use energy::energy;
pub(crate) use packings::packings;
pub(crate) use run::{Runs, prepared};
pub(crate) use settings::VariedSetting;
