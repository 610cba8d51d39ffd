//! `grainlab bag`: commands for recordings, as `ros2 bag`.

mod check;
#[cfg(feature = "studio")]
mod export;
mod info;
mod record;
mod recover;

use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;
use grainlab_recorder::play;

/// Commands for recordings.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Record topics until SIGINT or SIGTERM.
    Record(record::Args),
    /// Publish the messages of a recording.
    Play(play::Args),
    /// Show the content of a recording.
    Info(info::Args),
    /// Read every record of a recording and list all faults.
    Check(check::Args),
    /// Write the packings of a recording as LAMMPS dump or CSV files.
    #[cfg(feature = "studio")]
    Export(export::Args),
    /// Complete a recording whose recorder was killed, so that other tools read it.
    Recover(recover::Args),
    #[cfg(feature = "studio")]
    #[command(flatten)]
    Tool(grainlab_bag_tools::Command),
}

/// Runs the command.
pub(crate) fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::Record(args) => record::run(args),
        Command::Play(args) => play::run(args),
        Command::Info(args) => info::run(args),
        Command::Check(args) => check::run(args),
        #[cfg(feature = "studio")]
        Command::Export(args) => export::run(args),
        Command::Recover(args) => recover::run(args),
        #[cfg(feature = "studio")]
        Command::Tool(command) => grainlab_bag_tools::run(command),
    }
}
