//! `grainlab bag cut`.

use crate::output::{Job, Output};
use crate::selection::Topics;
use crate::times::Interval;
use grainlab_console::Failure;
use grainlab_msgs::Exit;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  grainlab bag cut recordings/runs/demo-1-1 --start-offset 2 --duration 1.5 -o middle
  grainlab bag cut run.mcap --end 2026-01-31T12:00:00Z --topics stress -o early.mcap

The messages from the start on and before the end. A topic that is latched (transient local) begins with the messages that a
late reader would have at the start: as many as the depth of its QoS, with the start as their log time and their own
publish time; --no-latched leaves them out. An existing output is not overwritten. Exit 3 if a part could not be read.";

/// Arguments of `grainlab bag cut`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Run directory or MCAP file
    #[arg(value_name = "PATH")]
    path: PathBuf,
    #[command(flatten)]
    interval: Interval,
    #[command(flatten)]
    topics: Topics,
    /// Leave out latched messages from before the start
    #[arg(long)]
    no_latched: bool,
    #[command(flatten)]
    output: Output,
}

/// Runs the command.
///
/// # Errors
/// If the recording cannot be read, a topic does not exist, or the output cannot be written.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    if !args.interval.is_set() {
        return Err(Failure::usage("a cut needs --start, --end, --start-offset or --duration"));
    }
    let paths = std::slice::from_ref(&args.path);
    let (topics, interval) = (&args.topics, &args.interval);
    Job { operation: "cut", paths, topics, interval, latched: !args.no_latched, pictures: false }
        .run(&args.output)
}
