//! Tools of `grainlab bag` for any ROS 2 recording in MCAP: ours, those of `ros2 bag`, and those of other programs.
//!
//! - `cat`: messages as JSON or text
//! - `convert`: one table per topic, as CSV or JSON; or a recording made from others
//! - `diff`: recordings compared

mod appended;
mod cat;
mod convert;
mod csv_table;
mod decoders;
mod diff;
mod progress;
mod selection;
mod shape;
mod tables;
#[cfg(test)]
mod testing;
mod times;

use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_msgs::Exit;

/// Commands for recordings of any type.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Print messages as JSON or text.
    Cat(cat::Args),
    /// Compare two recordings, topic by topic.
    Diff(diff::Args),
    /// Write one table per topic, as JSON lines or CSV; or a recording made from others.
    Convert(convert::Args),
}

/// Runs a command.
///
/// # Errors
/// If a recording cannot be read, an argument does not fit it, or the output cannot be written.
pub fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::Cat(args) => cat::run(args),
        Command::Diff(args) => diff::run(args),
        Command::Convert(args) => convert::run(args),
    }
}
