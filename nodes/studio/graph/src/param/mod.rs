//! The command `grainlab param`.

mod client;
mod commands;
mod value;

use crate::view::Common;
use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;
use std::path::PathBuf;

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
    /// Describe parameters: type, range, unit, and whether they can be set.
    #[command(after_help = "Example:\n  grainlab param describe /dem_simulator threads simd")]
    Describe {
        /// Name of the node
        node: String,
        /// Names of the parameters [default: all]
        parameters: Vec<String>,
        /// Format of the output and time limit.
        #[command(flatten)]
        common: Common,
    },
    /// Print all parameters of a node as a parameter file for --params-file.
    #[command(after_help = "Example:\n  grainlab param dump /dem_simulator > simulator.yaml")]
    Dump {
        /// Name of the node
        node: String,
        /// Format of the output and time limit.
        #[command(flatten)]
        common: Common,
    },
    /// Set the parameters of a node that a parameter file has.
    #[command(
        after_help = "Example:\n  grainlab param load /dem_simulator simulator.yaml\n\nExit 1 if the node refuses one: those that are read-only and \
                      differ are given at its start, with --params-file."
    )]
    Load {
        /// Name of the node
        node: String,
        /// Parameter file, as `dump` prints it
        file: PathBuf,
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
        Command::Describe { node, parameters, common } => commands::describe(node, parameters, common),
        Command::Dump { node, common } => commands::dump(node, common),
        Command::Load { node, file, common } => commands::load(node, file, common),
    }
}
