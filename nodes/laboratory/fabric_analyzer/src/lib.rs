//! The analyzer node: measures structure, stress and stiffness of packings.
//!
//! - [`parameters()`]: the parameters of the node; [`Settings`]: their values, typed
//! - [`measure()`]: the work of the node, a pure function of one message
//! - [`FabricAnalyzer`]: the node; [`Analysis`]: what it publishes

mod measure;
mod node;
mod settings;

pub use measure::{MeasureError, Measured, measure};
pub use node::{Analysis, FabricAnalyzer};
pub use settings::{Settings, SettingsError, parameters};
