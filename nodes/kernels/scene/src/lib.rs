//! What to simulate: grains, material, numerics and a loading path, parsed from text.
//!
//! - [`model`]: the scene as a value
//! - [`parse`]: text (TOML) to [`Scene`], with every fault reported at once
//! - [`path`]: the loading path as a state machine
//!
//! A scene is data: the same text and seed always mean the same run.

mod contact;
pub mod fault;
pub mod model;
pub mod parse;
pub mod path;
mod phases;
mod table;

pub use fault::{Fault, SceneError};
pub use model::{Condition, Conditions, GasMethod, Measure, Numerics, Phase, PhaseKind, Scene};
pub use path::{Observation, PathError, PathEvent, PathState};
