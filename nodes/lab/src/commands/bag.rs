//! `grainlab bag`: recordings, as `ros2 bag`.

mod info;
mod play;
mod record;

use crate::failure::Failure;
use clap::Subcommand;
use node_kit::Exit;

/// What to do with a recording.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Record topics until SIGINT or SIGTERM.
    Record(record::Args),
    /// Publish what was recorded.
    Play(play::Args),
    /// Show what a recording holds.
    Info(info::Args),
}

/// Runs the command.
pub(crate) fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::Record(args) => record::run(args),
        Command::Play(args) => play::run(args),
        Command::Info(args) => info::run(args),
    }
}
