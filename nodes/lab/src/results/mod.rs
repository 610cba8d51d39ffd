//! Results of commands, as they are printed and stored.

pub(crate) mod acoustic;
mod acoustic_text;
pub(crate) mod brief;
pub(crate) mod continuity;
pub(crate) mod inference;
pub(crate) mod inference_text;
pub(crate) mod measured_packing;
pub(crate) mod packing_text;
pub(crate) mod probe;
pub(crate) mod probed;
pub(crate) mod quantities;
pub(crate) mod read_back;
pub(crate) mod state_warnings;
pub(crate) mod summary;
pub(crate) mod summary_text;
