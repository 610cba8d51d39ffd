//! The inversion node: infers the microstructure from reports of packings, moduli and wave speeds.
//!
//! - [`parameters()`]: the parameters of the node; [`Settings`]: their values, typed
//! - [`microstructure_of_report`], [`microstructure_of_moduli`], [`microstructure_of_speeds`]: the work of the node, pure functions
//!   of one message
//! - [`EmtInversion`]: the node

mod message;
mod moduli;
mod node;
mod observed;
mod settings;
mod speeds;

pub use message::{Answer, microstructure_of_moduli, microstructure_of_report, microstructure_of_speeds};
pub use node::EmtInversion;
pub use settings::{Axis, Settings, SettingsError, parameters};
pub use speeds::notes_on_fit;
