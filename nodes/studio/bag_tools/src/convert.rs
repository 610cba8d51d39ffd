//! `grainlab bag convert`.

use crate::excerpt::Excerpt;
use crate::opened::losses;
use crate::output::{Form, Job};
use crate::tables::{TableFormat, Tables};
use clap::ValueEnum;
use grainlab_console::{Failure, print, worse};
use grainlab_msgs::Exit;
use grainlab_recordings::{MessagePath, NewPath};
use std::path::PathBuf;
use std::slice::from_ref;

const EXAMPLES: &str = "\
Examples:
  grainlab bag convert recordings/runs/demo-1-1 --format csv -o tables
  grainlab bag convert run.mcap --topics stress --format parquet -o tables
  grainlab bag convert recordings/runs/demo-1-1 --topics microstructure --explode estimates --format csv -o estimates
  grainlab bag convert old --format mcap --compression lz4 -o new
  grainlab bag convert recordings/runs/demo-1-1 --pictures -o pictures.mcap      # for RViz, Foxglove, Lichtblick, Rerun

json, csv, parquet: a new folder with one file per topic, or per definition of its type: /a/b is a_b.csv, the next a_b.2.csv. json has the lines of `grainlab bag cat`. csv and
parquet have one row per message, with log_time and publish_time (ns since 1970; in Parquet timestamps).
parquet: a message is a struct, an array a list, uint8[] bytes. csv: fields are flattened, stress.xx; an array with at most
--array-columns values in every message is as many columns, rate[0], a longer one is JSON in one column; values that are not there are empty.
--explode estimates: a row for each value of the array, with its index from 0; an empty array has no row; a topic without the array has
a row per message.
mcap: the recording written again. --pictures adds /packing/points (sensor_msgs/PointCloud2: x, y, z, radius, id, coordination, normal_force, rattler, and for Rerun radii, colors)
and /packing/markers (visualization_msgs/MarkerArray in the namespaces grains, contacts, cell) in the frame `cell`. Exit 3 if a part could not be read or decoded.";

/// Arguments of `grainlab bag convert`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    #[command(flatten)]
    excerpt: Excerpt,
    #[command(flatten)]
    messages: MessagePath,
    /// New folder; for mcap a new recording: a directory, or one file if the name ends with .mcap
    #[arg(short, long, alias = "out", value_name = "OUT")]
    output: PathBuf,
    /// Format of the output [default: csv; with --pictures, or a name that ends with .mcap: mcap]
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// Write a recording with pictures of the packings, for viewers that do not read packings
    #[arg(long)]
    pictures: bool,
    /// Write a row for each value of this array, with the other fields of the message beside it: estimates
    #[arg(long, value_name = "ARRAY")]
    explode: Option<String>,
    /// Longest array that is written as columns of CSV
    #[arg(long, value_name = "N", default_value_t = 36)]
    array_columns: usize,
    #[command(flatten)]
    form: Form,
}

/// Formats of the output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// JSON lines, one file per topic
    Json,
    /// Comma-separated values, one file per topic
    Csv,
    /// Apache Parquet, one file per topic
    Parquet,
    /// Recording in MCAP
    Mcap,
}

/// Runs the command.
///
/// # Errors
/// If the recording cannot be read, a topic does not exist, or the output cannot be written.
pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    let is_recording = args.pictures || args.output.extension().is_some_and(|e| e == "mcap");
    let format = match args.format.unwrap_or(if is_recording { Format::Mcap } else { Format::Csv }) {
        Format::Parquet => TableFormat::Parquet,
        Format::Csv => TableFormat::Csv,
        Format::Json => TableFormat::Json,
        Format::Mcap => {
            if args.explode.is_some() {
                return Err(Failure::usage("--explode is for tables: choose --format csv, parquet or json"));
            }
            let Excerpt { path, topics, interval } = &args.excerpt;
            let (paths, pictures) = (from_ref(path), args.pictures);
            return Job {
                operation: "convert",
                paths,
                topics,
                interval,
                latched: true,
                pictures,
                schemas: None,
            }
            .write(&args.output, &args.form);
        }
    };
    if args.pictures {
        return Err(Failure::usage("--pictures are added to recordings: leave --format out, or choose mcap"));
    }
    args.form.refuse_given()?;
    let (recording, selection, wanted) = args.excerpt.open(&args.messages)?;
    let new = NewPath::begin(&args.output).map_err(Failure::usage)?;
    std::fs::create_dir(new.partial()).map_err(Failure::at(&args.output))?;
    let mut tables =
        Tables::new(&args.output, new.partial(), format, args.array_columns, args.explode.as_deref(), wanted);
    tables.convert(&recording, &selection)?;
    let (lines, decoders) = tables.finish()?;
    new.finish().map_err(Failure::at(&args.output))?;
    print(&format!("{}:\n{}", args.output.display(), lines.concat()))?;
    Ok(worse(losses(from_ref(&recording)), decoders.losses()))
}
