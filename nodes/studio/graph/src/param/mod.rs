//! The command `grainlab param`.

mod commands;
mod value;

use crate::view::Common;
use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;

/// Commands about parameters.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the parameters of a node, or of all nodes.
    #[command(after_help = "Example:\n  grainlab param list /dem_simulator")]
    List {
        /// Name of the node [default: every node that has parameters]
        node: Option<String>,
        /// Format of the output and time limit.
        #[command(flatten)]
        common: Common,
    },
    /// Print the value of a parameter.
    #[command(after_help = "Example:\n  grainlab param get /dem_simulator threads")]
    Get {
        /// Name of the node
        node: String,
        /// Name of the parameter
        parameter: String,
        /// Format of the output and time limit.
        #[command(flatten)]
        common: Common,
    },
    /// Set a parameter of a running node.
    #[command(
        after_help = "Example:\n  grainlab param set /dem_simulator use_sim_time true\n\nExit 1 if the node refuses the value. \
                      What a run computes follows from the values at its start, so that\nmost parameters are read-only."
    )]
    Set {
        /// Name of the node
        node: String,
        /// Name of the parameter
        parameter: String,
        /// Value, as YAML
        #[arg(allow_negative_numbers = true)]
        value: String,
        /// Format of the output and time limit.
        #[command(flatten)]
        common: Common,
    },
}

/// Runs the command.
///
/// # Errors
/// With the exit code and the message for the user.
pub fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::List { node, common } => commands::list(node.as_deref(), common),
        Command::Get { node, parameter, common } => commands::get(node, parameter, common),
        Command::Set { node, parameter, value, common } => commands::set(node, parameter, value, common),
    }
}
