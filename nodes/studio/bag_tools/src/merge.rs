//! `grainlab bag merge`.

use crate::output::{Job, Output};
use crate::selection::Topics;
use crate::times::Interval;
use grainlab_console::Failure;
use grainlab_msgs::Exit;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  grainlab bag merge first second -o both
  grainlab bag merge robot.mcap camera.mcap --exclude /rosout -o all.mcap

Messages in order of log time; those of equal time in the order of the recordings. A message that several recordings have, with
the same times and bytes, is written once, which is said. A topic of several recordings becomes one,
with the QoS of the first; it is an error if its fields differ. Stored files and metadata records are kept; those with the
same name and different content get a number, with a message. Exit 3 if a part could not be read.";

/// Arguments of `grainlab bag merge`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Run directories or MCAP files
    #[arg(value_name = "PATH", required = true, num_args = 1..)]
    paths: Vec<PathBuf>,
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
/// If a recording cannot be read, topics contradict each other, or the output cannot be written.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let (topics, interval) = (&args.topics, &args.interval);
    Job { operation: "merge", paths: &args.paths, topics, interval, latched: true, pictures: false }
        .run(&args.output)
}
