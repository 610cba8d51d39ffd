//! The acoustic node: sends waves through packings and publishes their speeds.
//!
//! - [`parameters`]: what can be set; [`Settings`]: the same, typed
//! - [`measure()`]: the whole work, a pure function of one message; [`messages`]: its second half
//! - [`AcousticProbe`]: the node; [`Probe`]: what it publishes
//!
//! What is published is what an instrument could know: speeds, density, pressure, solid fraction and the material of the
//! grains. Nothing that was counted in the packing is among it.

mod measure;
mod node;
mod parameters;
mod settings;

pub use measure::{MeasureError, Measured, measure, messages};
pub use node::{AcousticProbe, DECLINED_STEP, MEASURING, Probe};
pub use parameters::parameters;
pub use settings::{Settings, SettingsError};
