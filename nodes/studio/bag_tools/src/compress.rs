//! `grainlab bag compress`.

use crate::output::{Job, Output};
use crate::selection::Topics;
use crate::times::Interval;
use grainlab_console::Failure;
use grainlab_msgs::Exit;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  grainlab bag compress run.mcap --compression lz4 -o small.mcap
  grainlab bag compress recordings/runs/demo-1-1 --preset zstd_small -o archive

Writes the recording again, with every message. Exit 3 if a part could not be read.";

/// Arguments of `grainlab bag compress`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Run directory or MCAP file
    #[arg(value_name = "PATH")]
    path: PathBuf,
    #[command(flatten)]
    output: Output,
}

/// Runs the command.
///
/// # Errors
/// If the recording cannot be read, or the output cannot be written.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let paths = std::slice::from_ref(&args.path);
    let (topics, interval) = (&Topics::default(), &Interval::default());
    Job { operation: "compress", paths, topics, interval, latched: true, pictures: false }.run(&args.output)
}
