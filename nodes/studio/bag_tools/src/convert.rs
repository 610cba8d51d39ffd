//! `grainlab bag convert`: tables of a recording, or a recording made from others.

use crate::decoders::{Decoders, losses};
use crate::progress::Progress;
use crate::selection::Excerpt;
use crate::tables::{TableFormat, Tables};
use clap::ValueEnum;
use grainlab_console::{Failure, count, print, say, worse};
use grainlab_msgs::Exit;
use grainlab_recordings::copy::{CopyOptions, copy};
use grainlab_recordings::{Compression, MessagePath, NewPath, Recording, Selection};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::slice::from_ref;

const EXAMPLES: &str = "\
Examples:
  grainlab bag convert recordings/runs/demo-1-1 --format csv -o tables
  grainlab bag convert run.mcap --topics stress --format json -o tables
  grainlab bag convert recordings/runs/demo-1-1 --start-offset 2 --duration 1.5 -o middle.mcap
  grainlab bag convert robot.mcap camera.mcap --exclude /rosout --format mcap -o both
  grainlab bag convert old.mcap --msg-path my_ws/install/share -o complete.mcap
  grainlab bag convert recordings/runs/demo-1-1 --pictures -o pictures.mcap      # for RViz, Foxglove, Lichtblick, Rerun

json, csv: a new folder with one file per topic, or per definition of its type: /a/b is a_b.csv, the next a_b.2.csv. json has the lines of
`grainlab bag cat`. csv has one row per message, with log_time and publish_time (ns since 1970). Fields are flattened, stress.xx; an array with at most
--array-columns values in every message is as many columns, rate[0], a longer one is JSON in one column; values that are not there are empty.

mcap: a new recording, from one PATH or several, in order of log time. Payloads, times, sequences, definitions, stored files and metadata records are kept.
A topic that is latched (transient local) begins with the messages that a late reader would have at the start: as many as the depth of its QoS, with
the start as their log time and their own publish time. A message that several recordings have, with the same times and bytes, is
written once, whatever its sequence number, which is said. A topic of several recordings becomes one, with the QoS of the first; it is an error if its fields
differ. Stored files and metadata records with the same name and different content get a number, with a message.
With --msg-path, topics without the definition of their type get the one found there, or in this program; nothing is written if a message is not of it.
--pictures adds /packing/points (sensor_msgs/PointCloud2: x, y, z, radius, id, coordination, normal_force, rattler, and for Rerun radii, colors)
and /packing/markers (visualization_msgs/MarkerArray in the namespaces grains, contacts, cell) in the frame `cell`.

An existing output is not overwritten. Exit 3 if a part could not be read, decoded or kept.";

/// Arguments of `grainlab bag convert`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Run directory or MCAP file; several for mcap
    #[arg(value_name = "PATH", required = true, num_args = 1..)]
    paths: Vec<PathBuf>,
    #[command(flatten)]
    excerpt: Excerpt,
    #[command(flatten)]
    messages: MessagePath,
    /// New folder; for mcap a new recording: a directory as rosbag2 has it, or one file if the name ends with .mcap
    #[arg(short, long, alias = "out", value_name = "OUT")]
    output: PathBuf,
    /// Format of the output [default: csv; with several PATHs, --pictures, or a name that ends with .mcap: mcap]
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// Longest array that is written as columns of CSV
    #[arg(long, value_name = "N", default_value_t = 36)]
    array_columns: usize,
    /// Compression of a new recording [default: zstd]
    #[arg(long, value_enum, value_name = "KIND")]
    compression: Option<Compression>,
    /// Add pictures of the packings to a new recording, for viewers that do not read packings
    #[arg(long)]
    pictures: bool,
}

/// Formats of the output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// JSON lines, one file per topic
    Json,
    /// Comma-separated values, one file per topic
    Csv,
    /// Recording in MCAP
    Mcap,
}

/// Errors if a recording cannot be read, a topic does not exist or contradicts another, or writing fails.
pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    let is_recording =
        args.pictures || args.paths.len() > 1 || args.output.extension().is_some_and(|e| e == "mcap");
    let format = match args.format.unwrap_or(if is_recording { Format::Mcap } else { Format::Csv }) {
        Format::Mcap => return recording(args),
        Format::Csv => TableFormat::Csv,
        Format::Json => TableFormat::Json,
    };
    let [path] = &args.paths[..] else {
        let one = "tables are of one PATH: write one recording of several first, with --format mcap";
        return Err(Failure::usage(one));
    };
    for (flag, is_given) in [("--pictures", args.pictures), ("--compression", args.compression.is_some())] {
        if is_given {
            return Err(Failure::usage(format!(
                "{flag} is of recordings: leave it out, or choose --format mcap"
            )));
        }
    }
    let (recording, _) = args.messages.open(path)?;
    let (selection, wanted) = args.excerpt.select(&recording)?;
    let new = NewPath::begin(&args.output).map_err(Failure::usage)?;
    std::fs::create_dir(new.partial()).map_err(Failure::at(&args.output))?;
    let mut tables = Tables::new(&args.output, new.partial(), format, args.array_columns, wanted);
    tables.convert(&recording, &selection)?;
    let (lines, decoders) = tables.finish()?;
    new.finish().map_err(Failure::at(&args.output))?;
    print(&format!("{}:\n{}", args.output.display(), lines.concat()))?;
    Ok(worse(losses(from_ref(&recording)), decoders.losses()))
}

fn recording(args: &Args) -> Result<Exit, Failure> {
    if args.output.extension().is_some_and(|e| ["csv", "json", "jsonl"].iter().any(|table| e == *table)) {
        return Err(Failure::usage(format!(
            "{}: this would be a recording, and has the name of a table: give it a name that ends with .mcap, or the name of a \
             directory; tables are of one PATH",
            args.output.display()
        )));
    }
    let recordings =
        args.paths.iter().map(|path| open(path, &args.messages)).collect::<Result<Vec<_>, _>>()?;
    let (topics, start, end) = args.excerpt.find(&recordings)?;
    let ranges = recordings.iter().filter_map(Recording::time_range);
    let range = ranges.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let progress = Progress::new(range.map(|(a, b)| (start.unwrap_or(a).max(a), end.unwrap_or(b).min(b))))?;
    let options = CopyOptions {
        channel: &|channel| topics.take(channel),
        start,
        end,
        progress: &|time| progress.at(time),
        compression: args.compression.unwrap_or_default(),
        pictures: args.pictures,
    };
    let copied = copy(&recordings, &args.output, &options)?;
    drop(progress);
    copied.notes.iter().for_each(|note| say!("grainlab: {note}"));
    let latched = match copied.latched {
        0 => String::new(),
        n => format!(", {n} of them latched ones from before the start"),
    };
    let pictures = match copied.pictures {
        0 => String::new(),
        n => format!(", {} of packings", count(n, "picture")),
    };
    print(&format!(
        "{}: {} on {}{latched}{pictures}, {:.3} MB\n",
        args.output.display(),
        count(copied.messages, "message"),
        count(copied.topics as u64, "topic"),
        copied.bytes as f64 * 1e-6
    ))?;
    let without = recordings
        .iter()
        .flat_map(Recording::all_channels)
        .filter(|c| args.messages.is_given() && c.is_without_definition() && topics.take(c));
    let without: BTreeSet<String> = without.map(|c| format!("{}: {}", c.topic, c.advice())).collect();
    without.iter().for_each(|line| say!("grainlab: {line}"));
    let is_complete = without.is_empty() && !copied.is_incomplete;
    Ok(worse(losses(&recordings), if is_complete { Exit::Done } else { Exit::DataLoss }))
}

/// Opens a recording that is copied. With --msg-path, topics without a definition get the one found for them, if every message is of it.
fn open(path: &Path, definitions: &MessagePath) -> Result<Recording, Failure> {
    if !definitions.is_given() {
        return Recording::open(path).map_err(Failure::failed);
    }
    let (recording, defined) = definitions.open(path)?;
    let mut decoders = Decoders::default();
    for message in recording.messages(&Selection::topics(&defined)).map_err(Failure::failed)? {
        decoders.decode(&message);
    }
    match decoders.losses() {
        Exit::Done => Ok(recording),
        _ => Err(Failure::failed("the definitions found are not those of the messages: nothing was written")),
    }
}
