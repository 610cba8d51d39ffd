//! The engine: the state of a run and its public operations.
//!
//! - `engine`: construction, settings, observation
//! - `stepping`: steps, with checks, thermostat and upkeep of the lists of pairs
//! - `checkpoint`: a state to return to
//! - `spatial_order`: grains sorted along a space-filling curve
//! - `factory`: the engine behind the contract of `grainlab_engine`

pub(crate) mod checkpoint;
#[allow(clippy::module_inception)] // the file of the type
pub(crate) mod engine;
pub(crate) mod factory;
mod spatial_order;
mod stepping;
