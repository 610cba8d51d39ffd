//! The gas as hard spheres, moved from collision to collision.
//!
//! - `spheres`: the gas, one interval at a time
//! - `interval`: the events of one interval
//! - `pair`: when two grains collide, and their velocities after it
//! - `queue`: the next event

mod interval;
mod pair;
mod queue;
pub(crate) mod spheres;
