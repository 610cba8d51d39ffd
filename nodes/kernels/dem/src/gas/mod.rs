//! Gases of grains: the start of a packing.
//!
//! - `placement`: random placement with thermal velocities
//! - `event_driven`: hard spheres, moved from collision to collision
//! - `grid`: a grid of cells to find near grains, for both
//! - `error`: why a gas cannot begin or go on

mod error;
mod event_driven;
mod grid;
mod placement;

pub use error::GasError;
pub use event_driven::spheres::{Collisions, HardSpheres, mean_free_time};
pub use placement::{Gas, random_placement};
