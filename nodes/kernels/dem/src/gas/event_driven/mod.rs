//! The gas as hard spheres, moved from collision to collision.
//!
//! - `spheres`: the gas, one interval at a time
//! - `interval`: the events of one interval
//! - `pair`: when two grains collide, and their velocities after it
//! - `grid`: a grid of cells to find near grains
//! - `queue`: the next event

mod grid;
mod interval;
mod pair;
mod queue;
pub(crate) mod spheres;
