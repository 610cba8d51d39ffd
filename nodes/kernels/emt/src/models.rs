//! The models, one file each; [`crate::models`](fn@crate::models) lists them.

pub(crate) mod directional;
pub(crate) mod effective_medium;
mod equivalent;
pub(crate) mod free_contact;
pub(crate) mod hertz_mindlin;
pub(crate) mod ratio;
pub(crate) mod relaxed;
mod shear_ratio;
