//! The `grainlab` binary: every node, the launcher and the tools as subcommands.
//!
//! - [`cli`]: the command line, as typed
//! - [`commands`]: one module per command, which checks its arguments
//! - [`results`]: what is printed and stored: states, inferences, tables
//! - [`tape`]: a recording of what a node would publish

mod cli;
mod commands;
mod results;
mod tape;

fn main() -> std::process::ExitCode {
    cli::main()
}
