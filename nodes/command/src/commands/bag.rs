//! `grainlab bag`: commands for recordings, as `ros2 bag`.

mod check;
mod export;
mod info;
mod record;
mod recover;

use clap::Subcommand;
use grainlab_bag_tools::{cat, compress, convert, cut, filter, merge, play};
use grainlab_console::Failure;
use grainlab_node_kit::Exit;

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
    /// Print messages as JSON or text.
    Cat(cat::Args),
    /// Write one table per topic, as JSON lines, CSV or Parquet; or a recording again.
    Convert(convert::Args),
    /// Write an interval of time as a new recording.
    Cut(cut::Args),
    /// Write several recordings as one.
    Merge(merge::Args),
    /// Write some topics as a new recording.
    Filter(filter::Args),
    /// Write a recording with another compression.
    Compress(compress::Args),
    /// Write the packings of a recording as LAMMPS dump or CSV files.
    Export(export::Args),
    /// Complete a recording whose recorder was killed, so that other tools read it.
    Recover(recover::Args),
}

/// Runs the command.
pub(crate) fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::Record(args) => record::run(args),
        Command::Play(args) => play::run(args),
        Command::Info(args) => info::run(args),
        Command::Check(args) => check::run(args),
        Command::Cat(args) => cat::run(args),
        Command::Convert(args) => convert::run(args),
        Command::Cut(args) => cut::run(args),
        Command::Merge(args) => merge::run(args),
        Command::Filter(args) => filter::run(args),
        Command::Compress(args) => compress::run(args),
        Command::Export(args) => export::run(args),
        Command::Recover(args) => recover::run(args),
    }
}
