//! The servo node: returns a strain rate for every stress.
//!
//! - [`answer`]: the work of the node, a pure function of one message: the same stress always gets the same
//!   answer, so that a servo can be restarted in the middle of a run
//! - [`ServoController`]: the node
//! - [`parameters()`]: the parameters of the node

mod answer;
mod node;

pub use answer::{Refusal, answer};
pub use node::{ServoController, parameters};
