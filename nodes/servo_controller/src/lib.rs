//! The servo node: answers every stress with a strain rate.
//!
//! - [`answer`]: the whole work, a pure function of one message; the same question has the same answer, so a servo may
//!   die and be replaced in the middle of a run
//! - [`ServoController`]: the node
//! - [`parameters`]: what can be set; [`Settings`]: the same, typed

mod answer;
mod node;
mod settings;

pub use answer::{Refusal, answer};
pub use node::ServoController;
pub use settings::{Settings, parameters};
