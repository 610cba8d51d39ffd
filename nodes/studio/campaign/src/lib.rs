//! Campaigns: many runs, each in a folder of its own.
//!
//! - [`Campaign`]: the members, from a file; [`Member`]: one run
//! - [`Folder`]: where they are, and how far each of them came
//! - [`Engine`]: this machine, a cluster, or a script that does it
//!
//! A member is the command `grainlab launch … --run DIR`, which begins the run in DIR, continues it, or does nothing if it is
//! finished. So a campaign can be interrupted at any moment, and started again.

mod campaign;
mod command;
mod engine;
mod file;
mod folder;
mod member;
mod progress;

pub use campaign::Campaign;
pub use engine::{Engine, Options};
pub use folder::{Folder, MemberState};
pub use member::{Member, Setting};
