//! `grainlab bag cat`.

use crate::decoders::{Decoders, losses};
use crate::selection::Excerpt;
use clap::ValueEnum;
use grainlab_any_message::Shown;
use grainlab_console::{Failure, Output, worse};
use grainlab_msgs::Exit;
use grainlab_recordings::{Message, MessagePath};
use serde::Serialize;
use std::fmt::Display;
use std::io::{self, Write};
use std::path::PathBuf;
use std::slice::from_ref;

const EXAMPLES: &str = "\
Examples:
  grainlab bag cat recordings/runs/demo-1-1 --topics packing_report
  grainlab bag cat run.mcap --regex '/(stress|strain_rate)' --count 10 --format text --max-array 6

Every message is decoded by the schema in the recording; where it has none, by that of --msg-path or of ROS 2's common interfaces. json: one line per message, with topic, type, log_time and
publish_time (ns since 1970), sequence and data; numbers that are not finite are \"NaN\", \"Infinity\" and \"-Infinity\". Arrays are
complete without --max-array. A message that was recorded as JSON is printed as it is. Exit 3 if a part could not be read or decoded.";

/// Arguments of `grainlab bag cat`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Run directory or MCAP file
    #[arg(value_name = "PATH")]
    path: PathBuf,
    #[command(flatten)]
    excerpt: Excerpt,
    #[command(flatten)]
    messages: MessagePath,
    /// Print at most this many messages
    #[arg(short = 'n', long, value_name = "N")]
    count: Option<usize>,
    /// Format of printed messages
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    /// Print at most this many values of each array
    #[arg(long, value_name = "N")]
    max_array: Option<usize>,
}

/// Format of printed messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Format {
    /// One JSON object per line
    #[default]
    Json,
    /// As `ros2 topic echo` prints them
    Text,
}

/// Errors if the recording cannot be read, a topic does not exist, or stdout fails.
pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    let (recording, _) = args.messages.open(&args.path)?;
    let (selection, wanted) = args.excerpt.select(&recording)?;
    let messages = recording.messages(&selection).map_err(Failure::failed)?;
    let mut decoders = Decoders::default();
    let (mut out, mut line) = (Output::open(), Vec::new());
    let mut printed = 0;
    for message in messages.filter(|m| wanted.as_ref().is_none_or(|w| w.take(&m.channel))) {
        if args.count.is_some_and(|most| printed >= most) {
            break;
        }
        line.clear();
        let formatted = if message.channel.message_encoding == "json" {
            let Some(data) = decoders.json(&message) else { continue };
            match args.format {
                Format::Json => raw_json(&mut line, &message, &data),
                Format::Text => text(&mut line, &message, data + "\n"),
            }
        } else {
            let Some(decoded) = decoders.decode(&message) else { continue };
            let mut shown = Shown::new(&decoded);
            if let Some(longest) = args.max_array {
                shown = shown.shortened(longest);
            }
            match args.format {
                Format::Json => json(&mut line, &message, shown),
                Format::Text => text(&mut line, &message, shown.text()),
            }
        };
        formatted.map_err(Failure::failed)?;
        if !out.print(&String::from_utf8_lossy(&line))? {
            return Ok(Exit::Done);
        }
        printed += 1;
    }
    if !out.flush()? {
        return Ok(Exit::Done);
    }
    Ok(worse(losses(from_ref(&recording)), decoders.losses()))
}

#[derive(Serialize)]
struct Line<'a, D> {
    topic: &'a str,
    #[serde(rename = "type")]
    ros_type: &'a str,
    log_time: u64,
    publish_time: u64,
    sequence: u32,
    data: D,
}

pub(crate) fn json(out: &mut impl Write, message: &Message, data: impl Serialize) -> io::Result<()> {
    let line = Line {
        topic: &message.channel.topic,
        ros_type: &message.channel.ros_type,
        log_time: message.log_time,
        publish_time: message.publish_time,
        sequence: message.sequence,
        data,
    };
    serde_json::to_writer(&mut *out, &line)?;
    out.write_all(b"\n")
}

/// Writes a message whose data are JSON as they are.
fn raw_json(line: &mut Vec<u8>, message: &Message, data: &str) -> io::Result<()> {
    json(line, message, ())?;
    line.truncate(line.len() - b"null}\n".len());
    writeln!(line, "{data}}}")
}

fn text(out: &mut impl Write, message: &Message, data: impl Display) -> io::Result<()> {
    let (seconds, ns) = (message.log_time / 1_000_000_000, message.log_time % 1_000_000_000);
    writeln!(out, "# {} {seconds}.{ns:09}\n{data}---", message.channel.topic)
}
