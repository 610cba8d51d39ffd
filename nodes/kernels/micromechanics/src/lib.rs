//! Structure and stiffness of a packing: fabric, coordination, and the moduli of the frozen contact network.
//!
//! [`analyze`], the entry point of node and command line, measures a packing once ([`PackingView`]) and
//! returns a [`grainlab_core::results::PackingReport`]. The parts are public, too:
//!
//! - [`structure`]: contacts, fabric, stress, strain ratios
//! - [`network`]: the frozen contact network and its stiffness
//! - [`probe`]: the same stiffness by straining the packing with the whole contact law
//! - [`unbalanced_force_ratio`]: distance from equilibrium
//! - [`sampling_tolerance()`]: scatter of the stiffness of one packing
//! - [`MicroError`], [`ProbeError`]: errors

mod analyze;
mod equilibrium;
mod error;
pub mod network;
pub mod probe;
mod sampling_tolerance;
pub mod structure;
mod tolerances;
mod view;

pub use analyze::{Analysis, Settings, analyze};
pub use equilibrium::unbalanced_force_ratio;
pub use error::{MicroError, ProbeError};
pub use sampling_tolerance::sampling_tolerance;
pub use tolerances::TOLERANCES;
pub use view::PackingView;
