//! `grainlab param`.

mod client;
mod commands;
mod value;

use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;

/// What to do with parameters.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the parameters of a node, or of all nodes.
    List(commands::ListArgs),
    /// Print the value of a parameter.
    Get(commands::GetArgs),
    /// Set a parameter of a running node.
    Set(commands::SetArgs),
    /// Describe parameters: type, range, unit, and whether they can be set.
    Describe(commands::DescribeArgs),
    /// Print all parameters of a node as a parameter file for --params-file.
    Dump(commands::DumpArgs),
}

/// Runs the command.
///
/// # Errors
/// With the exit code and the message for the user.
pub fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::List(args) => commands::list(args),
        Command::Get(args) => commands::get(args),
        Command::Set(args) => commands::set(args),
        Command::Describe(args) => commands::describe(args),
        Command::Dump(args) => commands::dump(args),
    }
}
