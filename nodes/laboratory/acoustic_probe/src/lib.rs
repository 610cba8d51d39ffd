//! The acoustic node: sends waves through packings and publishes their speeds.
//!
//! - [`parameters()`]: the parameters of the node; [`Settings`]: their values, typed
//! - [`measure()`]: the work of the node, a pure function of one message; [`messages`]: its second half
//! - [`AcousticProbe`]: the node; [`Probe`]: what it publishes
//!
//! It publishes only what an instrument can measure: speeds, density, pressure, solid fraction and the
//! material of the grains. No quantity counted in the packing is included.

mod measure;
mod node;
mod parameters;
mod settings;

pub use measure::{MeasureError, Measured, measure, messages};
pub use node::{AcousticProbe, Probe};
pub use parameters::{methods_with, parameters};
pub use settings::{Settings, SettingsError};
