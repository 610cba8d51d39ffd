//! LAMMPS as an engine: an `lmp` on the PATH or by name, alone or under `mpiexec -n R` or `srun`, driven by commands through a
//! pipe. Nothing is linked.
//!
//! - [`Lammps`]: the factory; `engine`: one run; `exchange`: its commands for some steps
//! - `law`: the contact law as commands, and parts of a scene that LAMMPS does not have
//! - `frame`: the cell as LAMMPS has it, and the affine velocities in it
//! - `files`: packings to and from files of LAMMPS; `coulomb`: their contacts at the Coulomb limit
//! - `survey`: time step and tangent stiffness, by our engine
//! - `program`: the process, its pipe, and its end; `folder`: its files; `refusal`: errors
//!
//! # Model
//! Grains have velocities of the laboratory, u + L x, in a box that deforms linearly during an exchange (`fix deform ... remap
//! v`). At every exchange velocities change by (L' − L) x, and drag acts on u. Differences from our engine:
//!
//! - A stress is that of all forces, dashpots included.
//! - The Coulomb limit is a fraction of the normal force with its dashpot. A packing has the tangential force of a contact that is
//!   at it as our engine has it: the fraction of the elastic normal force.
//! - Spins move a contact with the lever R in place of R − δ/2.
//! - The tangential force does not turn with the mean spin of two grains about their normal.

mod coulomb;
mod engine;
mod exchange;
mod factory;
mod files;
mod folder;
mod frame;
mod law;
mod program;
mod refusal;
mod survey;

pub use factory::Lammps;
pub use law::check_scene;
pub use refusal::NAME;
