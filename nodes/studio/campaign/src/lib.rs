//! Campaigns: many runs, each in a folder of its own.
//!
//! - [`Campaign`]: the members, from a file; [`Member`]: one run; [`reference()`]: every key of the file
//! - [`Folder`]: the folder of every member, and its state
//! - [`Engine`]: runs the members on this machine or on a cluster, or prints a script that runs them
//!
//! A member is run by the command `grainlab launch … --run DIR`, which begins the run in DIR, continues it, or does nothing if it is
//! finished. So a campaign can be interrupted at any moment, and started again.

mod campaign;
mod command;
mod engine;
mod file;
mod folder;
mod member;
mod progress;
mod reference;

pub use campaign::Campaign;
pub use engine::{Engine, Options};
pub use folder::{Folder, MemberState, Standing};
pub use member::{Member, Setting};
pub use reference::reference;
