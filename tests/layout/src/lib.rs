//! Rules that the source of every crate keeps, read off the source itself.
//!
//! - [`modules`]: the modules of a crate, a file each
//! - [`imports`]: which module uses which, re-exports resolved to where an item is defined
//! - [`rules`]: what breaks a rule, in words

pub mod imports;
pub mod modules;
pub mod rules;
