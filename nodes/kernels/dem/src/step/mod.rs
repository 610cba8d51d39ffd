//! One step: forces and motion of all grains, and its length.
//!
//! - `pass`: one pass over the chunks of grains, forces, motion or both
//! - `integrate`: motion of a chunk
//! - `time_step`: the stable time step

pub(crate) mod integrate;
pub(crate) mod pass;
pub(crate) mod time_step;
