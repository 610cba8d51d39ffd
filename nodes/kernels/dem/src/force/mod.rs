//! Contact forces.
//!
//! - `geometry`: where pairs are and whether they touch
//! - `stages`: geometry, law and scatter, block after block
//! - `kernel`: forces and torques of a chunk of pairs
//! - `virial`: the stress that these forces carry

pub(crate) mod geometry;
pub(crate) mod kernel;
mod stages;
pub(crate) mod virial;
