//! The servo node: answers every stress with a strain rate.
//!
//! - [`answer`]: the whole work, a pure function of one message; the same question has the same answer, so a servo may
//!   die and be replaced in the middle of a run
//! - [`ServoController`]: the node; it has no parameters, because the question holds everything

mod answer;
mod node;

pub use answer::{Refusal, answer};
pub use node::ServoController;

/// The parameters of the node: none.
pub fn parameters() -> Vec<node_kit::ParameterSpec> {
    Vec::new()
}
