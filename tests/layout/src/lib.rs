//! Rules that the source of every crate keeps, read off the source itself.
//!
//! - `modules`: the modules of a crate, a file each
//! - `imports`: which module uses which, re-exports resolved to where an item is defined
//! - `rules`: what breaks a rule, in words
//! - `samples`: the rules find what breaks them; `workspace`: every crate keeps them

// All of it is tests: a build without tests does not pay for it.
#![cfg(test)]

mod imports;
mod modules;
mod rules;
mod samples;
mod workspace;
