//! Contact forces.
//!
//! - `geometry`: where pairs are and whether they touch
//! - `kernel`: forces and torques of a chunk of pairs
//! - `virial`: the stress that these forces carry

pub(crate) mod geometry;
pub(crate) mod kernel;
pub(crate) mod virial;
