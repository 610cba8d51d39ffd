//! `grainlab bench`: speed on this machine.

mod lockstep;

use crate::failure::Failure;
use clap::Subcommand;
use node_kit::Exit;

/// What to measure.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// One exchange of the lockstep between two processes, with a recorder attached, beside bare ros2-client.
    Lockstep(lockstep::Args),
}

/// Runs the command.
pub(crate) fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::Lockstep(args) => lockstep::run(args),
    }
}
