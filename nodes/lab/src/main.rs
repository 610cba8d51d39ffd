//! The `grainlab` binary: every node, the launcher and the tools as subcommands.
//!
//! - [`cli`]: the command line, as typed
//! - [`commands`]: one module a command; low arguments become checked ones there
//! - [`results`]: what is printed and stored: states, inferences, tables
//! - [`failure`], [`output`]: how a command ends, and where its result goes
//! - [`scenes`]: the scenes built in
//! - [`launch`]: launch files, processes and their supervision
//! - [`lifeline`]: ends a node whose launcher died
//! - [`recorder`]: the recorder node
//! - [`tape`]: a recording of what a node would publish
//! - [`network`]: buses of tools, free domains

mod cli;
mod commands;
mod failure;
mod launch;
mod lifeline;
mod network;
mod output;
mod recorder;
mod results;
mod scenes;
mod start;
mod tape;

fn main() -> std::process::ExitCode {
    cli::main()
}
