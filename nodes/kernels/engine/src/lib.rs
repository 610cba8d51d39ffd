//! What a run asks of the program that moves the grains.
//!
//! - [`ParticleEngine`], [`EngineFactory`]: the contract; `grainlab_dem` is one engine, LAMMPS another
//! - [`EngineSettings`]: the settings of a phase; [`Compute`]: threads, and the flag that stops a computation
//! - [`Observables`], [`EnergyBalance`]: what an engine measures; [`EngineProgram`](grainlab_core::EngineProgram): a program that is not ours
//! - [`EngineError`]: why an engine cannot start or go on

mod compute;
mod energy;
mod error;
mod particle_engine;
mod settings;

pub use compute::{Compute, ThreadsError};
pub use energy::EnergyBalance;
pub use error::EngineError;
pub use particle_engine::{EngineFactory, Observables, ParticleEngine};
pub use settings::{EngineSettings, Features, TimeStep};
