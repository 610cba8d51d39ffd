//! `grainlab bag filter`.

use crate::output::{Job, Output};
use crate::selection::Topics;
use crate::times::Interval;
use grainlab_console::Failure;
use grainlab_msgs::Exit;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  grainlab bag filter recordings/runs/demo-1-1 --topics packing packing_report -o results
  grainlab bag filter run.mcap --regex '/camera/.*' --exclude /camera/raw -o camera.mcap

Stored files and metadata are kept. An existing output is not overwritten. Exit 3 if a part could not be read.";

/// Arguments of `grainlab bag filter`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Run directory or MCAP file
    #[arg(value_name = "PATH")]
    path: PathBuf,
    #[command(flatten)]
    topics: Topics,
    #[command(flatten)]
    interval: Interval,
    #[command(flatten)]
    output: Output,
}

/// Runs the command.
///
/// # Errors
/// If the recording cannot be read, a topic does not exist, or the output cannot be written.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let paths = std::slice::from_ref(&args.path);
    let (topics, interval) = (&args.topics, &args.interval);
    Job { operation: "filter", paths, topics, interval, latched: true, pictures: false }.run(&args.output)
}
