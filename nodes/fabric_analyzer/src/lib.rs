//! The analyzer node: turns packings into fabric and moduli.
//!
//! - [`parameters`]: what can be set; [`Settings`]: the same, typed
//! - [`measure()`]: the whole work, a pure function of one message; [`messages`]: its second half
//! - [`FabricAnalyzer`]: the node; [`Analysis`]: what it publishes

mod measure;
mod node;
mod settings;

pub use measure::{MeasureError, Measured, measure, messages};
pub use node::{Analysis, FabricAnalyzer};
pub use settings::{Settings, SettingsError, parameters};
