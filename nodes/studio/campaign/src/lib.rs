//! Campaigns: many runs, each in a folder of its own.
//!
//! - [`Campaign`]: the members, from a file; [`Member`]: one run
//! - [`Folder`]: where they are, and how far each of them came
//! - [`run_state`]: how far a run came, from its directory
//! - [`Engine`]: this machine, a cluster, or a script that does it
//!
//! A member is the command `grainlab launch … --run DIR`, which begins the run in DIR, continues it, or does nothing if it is
//! finished. So a campaign can be interrupted at any moment, and started again.

mod campaign;
mod command;
mod engine;
mod file;
mod folder;
mod lock;
mod member;
mod progress;
mod run_state;

pub use campaign::Campaign;
pub use engine::{Engine, Options};
pub use folder::{Folder, MemberState};
pub use lock::Lock;
pub use member::{Member, Setting};
pub use run_state::{RunState, run_state};
