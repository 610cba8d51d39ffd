//! `grainlab bag cut`, `merge`, `filter` and `compress`: recordings made from others.

use crate::excerpt::Excerpt;
use crate::output::{Job, Output};
use crate::selection::Topics;
use crate::times::Interval;
use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_msgs::Exit;
use grainlab_recordings::MessagePath;
use std::path::PathBuf;
use std::slice::from_ref;

const CUT: &str = "\
Examples:
  grainlab bag cut recordings/runs/demo-1-1 --start-offset 2 --duration 1.5 -o middle
  grainlab bag cut run.mcap --end 2026-01-31T12:00:00Z --topics stress -o early.mcap

The messages from the start on and before the end. A topic that is latched (transient local) begins with the messages that a
late reader would have at the start: as many as the depth of its QoS, with the start as their log time and their own
publish time; --no-latched leaves them out. An existing output is not overwritten. Exit 3 if a part could not be read.";

const MERGE: &str = "\
Examples:
  grainlab bag merge first second -o both
  grainlab bag merge robot.mcap camera.mcap --exclude /rosout -o all.mcap

Messages in order of log time; those of equal time in the order of the recordings. A message that several recordings have, with
the same times and bytes, is written once, whatever its sequence number, which is said. A topic of several recordings becomes one,
with the QoS of the first; it is an error if its fields differ. Stored files and metadata records are kept; those with the
same name and different content get a number, with a message. Exit 3 if a part could not be read.";

const FILTER: &str = "\
Examples:
  grainlab bag filter recordings/runs/demo-1-1 --topics packing packing_report -o results
  grainlab bag filter run.mcap --regex '/camera/.*' --exclude /camera/raw -o camera.mcap

Stored files and metadata are kept. An existing output is not overwritten. Exit 3 if a part could not be read.";

const COMPRESS: &str = "\
Examples:
  grainlab bag compress run.mcap --compression lz4 -o small.mcap
  grainlab bag compress recordings/runs/demo-1-1 --preset zstd_small -o archive

Writes the recording again, with every message. Exit 3 if a part could not be read.";

const ADD_SCHEMAS: &str = "\
Examples:
  grainlab bag add-schemas old.mcap --msg-path my_ws/install/share -o complete.mcap

Writes the recording again; a topic that was recorded without the definition of its type gets that in package/msg/Type.msg below --msg-path,
or that of this program and of ROS 2's common interfaces. Nothing is written if a message is not of it. Exit 3 if a topic is left without.";

/// Commands that make a recording from others.
#[derive(Debug, Subcommand)]
#[expect(missing_docs, reason = "the fields are arguments, which their types describe")]
pub enum Copies {
    /// Write an interval of time as a new recording.
    #[command(after_help = CUT)]
    Cut {
        #[command(flatten)]
        excerpt: Excerpt,
        /// Leave out latched messages from before the start
        #[arg(long)]
        no_latched: bool,
        #[command(flatten)]
        output: Output,
    },
    /// Write several recordings as one.
    #[command(after_help = MERGE)]
    Merge {
        /// Run directories or MCAP files
        #[arg(value_name = "PATH", required = true, num_args = 1..)]
        paths: Vec<PathBuf>,
        #[command(flatten)]
        topics: Topics,
        #[command(flatten)]
        interval: Interval,
        #[command(flatten)]
        output: Output,
    },
    /// Write some topics as a new recording.
    #[command(after_help = FILTER)]
    Filter {
        #[command(flatten)]
        excerpt: Excerpt,
        #[command(flatten)]
        output: Output,
    },
    /// Write a recording with the definitions of types that it lacks.
    #[command(after_help = ADD_SCHEMAS)]
    AddSchemas {
        /// Run directory or MCAP file
        #[arg(value_name = "PATH")]
        path: PathBuf,
        #[command(flatten)]
        messages: MessagePath,
        #[command(flatten)]
        output: Output,
    },
    /// Write a recording with another compression.
    #[command(after_help = COMPRESS)]
    Compress {
        /// Run directory or MCAP file
        #[arg(value_name = "PATH")]
        path: PathBuf,
        #[command(flatten)]
        output: Output,
    },
}

/// Runs a command.
///
/// # Errors
/// If a recording cannot be read, a topic does not exist, topics contradict each other, or the output cannot be written.
pub(crate) fn run(command: &Copies) -> Result<Exit, Failure> {
    let (all, always) = (Topics::default(), Interval::default());
    let (operation, paths, topics, interval, latched, output) = match command {
        Copies::Cut { excerpt, .. } if !excerpt.interval.is_set() => {
            return Err(Failure::usage("a cut needs --start, --end, --start-offset or --duration"));
        }
        Copies::Cut { excerpt: Excerpt { path, topics, interval }, no_latched, output } => {
            ("cut", from_ref(path), topics, interval, !no_latched, output)
        }
        Copies::Merge { paths, topics, interval, output } => {
            ("merge", &paths[..], topics, interval, true, output)
        }
        Copies::Filter { excerpt: Excerpt { path, topics, interval }, output } => {
            ("filter", from_ref(path), topics, interval, true, output)
        }
        Copies::AddSchemas { path, output, .. } => {
            ("add-schemas", from_ref(path), &all, &always, true, output)
        }
        Copies::Compress { path, output } => ("compress", from_ref(path), &all, &always, true, output),
    };
    let schemas = if let Copies::AddSchemas { messages, .. } = command { Some(messages) } else { None };
    let job = Job { operation, paths, topics, interval, latched, pictures: false, schemas };
    job.write(&output.output, &output.form)
}
