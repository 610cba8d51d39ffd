//! The inversion node: turns moduli into microstructure.
//!
//! - [`parameters`]: what can be set; [`Settings`]: the same, typed
//! - [`microstructure_message`]: the whole work, a pure function of one message
//! - [`EmtInversion`]: the node

mod calibration;
mod estimate;
mod message;
mod models;
mod node;
mod observation;
mod settings;

pub use calibration::CalibrationChoice;
pub use message::microstructure_message;
pub use models::Models;
pub use node::EmtInversion;
pub use settings::{Axis, Settings, SettingsError, parameters};
