//! The particle engine: frictional spheres in a deforming periodic cell.
//!
//! [`Engine`] steps grains at a given strain rate; [`Dem`] starts such engines for runs, which know the contract of
//! `grainlab_engine` alone. The folders follow a step, each using those before it only:
//!
//! - `simd`: arithmetic in one, four or eight lanes
//! - `domain`: grains, and how they are divided among threads
//! - `pairs`: neighbours, and the blocks of pairs that may touch
//! - `force`: the force kernel, compiled for each contact law, and the stress that forces carry
//! - `step`: forces and motion of one step, and the stable time step
//! - `observe`: stress, tangent stiffness and force balance of the present contacts; the running energy balance
//! - `engine`: steps with checks, thermostat and upkeep of the lists of pairs; the engine behind the contract
//!
//! [`gas`] places grains at random and moves hard spheres from collision to collision.
//!
//! Every result is a function of the state alone. Sums run over contacts sorted by (i, j, image), by chunks and parts that
//! follow from the number of grains. So nothing depends on when neighbours were found, on the instruction set or on the number
//! of threads, and a state saved and loaded goes on bit for bit.

mod domain;
mod engine;
mod force;
pub mod gas;
mod observe;
mod pairs;
mod simd;
mod step;

pub use engine::checkpoint::Checkpoint;
pub use engine::engine::Engine;
pub use engine::factory::Dem;
pub use observe::observables::Observables;
pub use simd::instruction_set::{Simd, UnavailableSimd, UnknownSimd};
