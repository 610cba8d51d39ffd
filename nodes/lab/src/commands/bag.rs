//! `grainlab bag`: recordings, as `ros2 bag`.

mod check;
mod info;
mod play;
mod record;
mod recover;

use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;

/// What to do with a recording.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Record topics until SIGINT or SIGTERM.
    Record(record::Args),
    /// Publish what was recorded.
    Play(play::Args),
    /// Show what a recording holds.
    Info(info::Args),
    /// Read every record of a recording and name all that is wrong.
    Check(check::Args),
    /// Finish the recording of a recorder that was killed, so that other tools read it.
    Recover(recover::Args),
}

/// Runs the command.
pub(crate) fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::Record(args) => record::run(args),
        Command::Play(args) => play::run(args),
        Command::Info(args) => info::run(args),
        Command::Check(args) => check::run(args),
        Command::Recover(args) => recover::run(args),
    }
}
