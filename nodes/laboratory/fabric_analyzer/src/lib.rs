//! The analyzer node: measures fabric and moduli of packings.
//!
//! - [`parameters`]: the parameters of the node; [`Settings`]: their values, typed
//! - [`measure()`]: the work of the node, a pure function of one message; [`messages`]: its second half
//! - [`FabricAnalyzer`]: the node; [`Analysis`]: what it publishes

mod measure;
mod node;
mod settings;

pub use measure::{MeasureError, Measured, measure, messages};
pub use node::{Analysis, FabricAnalyzer, WITHOUT_MODULI};
pub use settings::{Settings, SettingsError, parameters};
