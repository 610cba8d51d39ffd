//! Rules for the source of every crate, checked on the source.
//!
//! - [`modules`]: the modules of a crate, one file each
//! - [`imports`]: the modules that a module uses, with re-exports resolved
//! - [`rules`]: violations of the rules, as text

pub mod imports;
pub mod modules;
pub mod rules;
