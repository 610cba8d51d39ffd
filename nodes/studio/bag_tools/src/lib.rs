//! Tools of `grainlab bag` for any ROS 2 recording in MCAP: ours, those of `ros2 bag`, and those of other programs.
//!
//! - `cat`: messages as JSON or text
//! - `convert`: one table per topic, as CSV or Parquet
//! - `cut`, `merge`, `filter`, `compress`: new recordings from others
//!
//! Each has the arguments of its command and `run`.

mod cat;
mod compress;
mod convert;
mod cut;
mod decoders;
mod filter;
mod merge;
mod opened;
mod output;
mod selection;
mod table;
mod tables;
mod times;

use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_msgs::Exit;

/// Commands for recordings of any type.
#[derive(Debug, Subcommand)]
pub enum Command {
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
}

/// Runs a command.
///
/// # Errors
/// If a recording cannot be read, an argument does not fit it, or the output cannot be written.
pub fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::Cat(args) => cat::run(args),
        Command::Convert(args) => convert::run(args),
        Command::Cut(args) => cut::run(args),
        Command::Merge(args) => merge::run(args),
        Command::Filter(args) => filter::run(args),
        Command::Compress(args) => compress::run(args),
    }
}
