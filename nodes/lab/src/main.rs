//! The `grainlab` binary: every node, the launcher and the tools as subcommands.
//!
//! - [`cli`]: the command line, as typed
//! - [`commands`]: one module a command; low arguments become checked ones there
//! - [`results`]: what is printed and stored: states, inferences, tables
//! - [`launch`]: launch files, processes and their supervision
//! - [`nodes`]: every node, and how it is started
//! - [`launcher_pipe`]: ends a node whose launcher died
//! - [`tape`]: a recording of what a node would publish

mod cli;
mod commands;
mod launch;
mod launcher_pipe;
mod nodes;
mod results;
mod tape;

fn main() -> std::process::ExitCode {
    cli::main()
}
