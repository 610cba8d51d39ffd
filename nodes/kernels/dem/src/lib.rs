//! The particle engine: frictional Hertz–Mindlin spheres in a deforming periodic cell.
//!
//! - [`simulation`]: a scene run along its loading path, one request and one answer at a time
//! - [`engine`]: stepping grains at a given strain rate
//! - [`law`]: the contact law, written once for any number of lanes; with `f64` it is the specification
//! - [`lanes`], [`simd`], [`compute`]: one, four or eight contacts at a time, on one thread or more, with the same bits
//! - [`gas`]: placing grains at random and agitating them
//! - [`event_driven`]: the gas as hard spheres, from collision to collision
//! - [`observe`]: stress, tangent stiffness and balance of the present contacts
//! - [`roofline`]: what the contact law asks of a processor, for benchmarks
//!
//! Everything is a function of the state alone: sums run over contacts sorted by (i, j, image), by chunks and parts that
//! follow from the number of grains, so nothing depends on when a neighbour list was rebuilt, on the instruction set or on the
//! number of threads, and a state saved and loaded goes on bit for bit.

mod approach;
mod checkpoint;
pub mod compute;
mod contacts;
pub mod engine;
pub mod error;
pub mod event_driven;
pub mod gas;
mod geometry;
mod homes;
mod images;
mod integrate;
pub mod lanes;
pub mod law;
mod neighbours;
pub mod observe;
mod order;
mod own;
mod pass;
pub mod roofline;
mod run_state;
mod share;
pub mod simd;
pub mod simulation;
mod state;
mod stress;
mod sums;
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
