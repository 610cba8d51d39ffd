//! The structure of the workspace, checked on its source.
//!
//! - `modules`: the modules of a crate, one file each
//! - `imports`: the modules that a module uses, with re-exports resolved
//! - `rules`: violations of the rules, as text
//! - `layers`: the order of crates; `dependencies`: what they link through others
//! - `outside`: a crate outside of the workspace uses ours; `installs`: texts install ours, not somebody else's
//! - `samples`: tests of the rules on small crates; `workspace`: every crate keeps them

// All of it is tests: a build without tests does not pay for it.
#![cfg(test)]

mod dependencies;
mod imports;
mod installs;
mod layers;
mod modules;
mod outside;
mod rules;
mod samples;
mod workspace;
