//! Rules for the source of every crate, checked on the source.
//!
//! - `modules`: the modules of a crate, one file each
//! - `imports`: the modules that a module uses, with re-exports resolved
//! - `rules`: violations of the rules, as text
//! - `layers`: the order of crates; `dependencies`: what they link through others
//! - `counts`: how much source there is
//! - `outside`: a crate outside of the workspace uses ours
//! - `samples`: tests of the rules on small crates; `workspace`: every crate keeps them

// All of it is tests: a build without tests does not pay for it.
#![cfg(test)]

mod counts;
mod dependencies;
mod imports;
mod layers;
mod modules;
mod outside;
mod rules;
mod samples;
mod workspace;
