//! The particle engine: frictional Hertz–Mindlin spheres in a deforming periodic cell.
//!
//! - [`simulation`]: a scene run along its loading path, one request and one answer at a time
//! - [`engine`]: stepping grains at a given strain rate
//! - [`law`]: the contact law, the specification of every faster form
//! - [`gas`]: placing grains at random and agitating them
//! - [`observe`]: stress, tangent stiffness and balance of the present contacts
//!
//! Everything is a function of the state alone: sums run over contacts sorted by (i, j, image), so nothing depends on
//! when a neighbour list was rebuilt, and a state saved and loaded goes on bit for bit.

mod checkpoint;
pub mod compute;
mod contacts;
pub mod engine;
pub mod error;
pub mod gas;
mod integrate;
pub mod lanes;
pub mod law;
mod neighbours;
pub mod observe;
mod order;
mod pass;
pub mod roofline;
mod run_state;
pub mod simd;
pub mod simulation;
mod state;
mod sweep;
mod time_step;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use compute::{Compute, ComputeError};
pub use engine::{Engine, Features, Setting, TimeStep};
pub use error::DemError;
pub use observe::Snapshot;
pub use simd::Simd;
pub use simulation::{Advanced, Request, Simulation};
