//! `grainlab node`.

mod info;
mod list;
mod state;

pub(crate) use info::find;

use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;

/// What to do with nodes.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the nodes of the domain.
    List(list::Args),
    /// Show the publishers, subscriptions and services of a node.
    Info(info::Args),
    /// Show what each node does or waits for, by its latest report.
    State(state::Args),
}

/// Runs the command.
///
/// # Errors
/// With the exit code and the message for the user.
pub fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::List(args) => list::run(args),
        Command::Info(args) => info::run(args),
        Command::State(args) => state::run(args),
    }
}
