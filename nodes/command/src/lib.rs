//! The command line of `grainlab`: every node, the launcher and the tools as subcommands. The binary is one caller, and Python the other.
//!
//! - `cli`: the command line, [`main`]
//! - `commands`: one module per command, with the checks of its arguments
//! - `hints`: advice for words that are not known here
//! - [`in_memory`]: commands on data in memory
//! - `offline_recording`: a recording of the messages that a node would publish

mod cli;
mod commands;
mod hints;
pub mod in_memory;
mod offline_recording;

pub use cli::main;
