//! The particle engine: frictional spheres in a deforming periodic cell.
//!
//! [`Engine`] steps grains at a given strain rate. Its folders follow a step, each using those before it only:
//!
//! - `simd`: arithmetic in one, four or eight lanes
//! - `domain`: grains, and how they are divided among threads
//! - `pairs`: neighbours, and the blocks of pairs that may touch
//! - `force`: the force kernel, compiled for each contact law, and the stress that forces carry
//! - `step`: forces and motion of one step, and the stable time step
//! - `observe`: stress, tangent stiffness and force balance of the present contacts; the running energy balance
//! - `engine`: steps with checks, thermostat and upkeep of the lists of pairs
//!
//! [`gas`] places grains at random and moves hard spheres from collision to collision.
//!
//! Every result is a function of the state alone. Sums run over contacts sorted by (i, j, image), by chunks and parts that
//! follow from the number of grains. So nothing depends on when neighbours were found, on the instruction set or on the number
//! of threads, and a state saved and loaded goes on bit for bit.

mod domain;
mod engine;
mod error;
mod force;
pub mod gas;
mod observe;
mod pairs;
mod settings;
mod simd;
mod step;

pub use domain::compute::{Compute, ComputeError};
pub use engine::checkpoint::Checkpoint;
pub use engine::engine::Engine;
pub use error::DemError;
pub use observe::energy::EnergyBalance;
pub use observe::observables::Observables;
pub use settings::{EngineSettings, Features, TimeStep};
pub use simd::instruction_set::{Simd, UnknownSimd};
