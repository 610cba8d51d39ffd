//! The inversion node: turns moduli into microstructure.
//!
//! - [`parameters`]: what can be set; [`Settings`]: the same, typed
//! - [`microstructure_message`]: the whole work, a pure function of one message
//! - [`EmtInversion`]: the node

mod message;
mod node;
mod settings;

pub use message::microstructure_message;
pub use node::EmtInversion;
pub use settings::{Settings, parameters};
