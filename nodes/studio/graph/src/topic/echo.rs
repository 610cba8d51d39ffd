//! `grainlab topic echo`.

use super::listen::Listener;
use super::qos::QosArgs;
use crate::view::{Common, OutputFormat, schema, seconds};
use grainlab_any_message::Shown;
use grainlab_console::{Failure, print_more, say};
use grainlab_node_kit::Exit;
use grainlab_recordings::MessagePath;
use std::time::{Duration, Instant};

/// A day: as good as no limit.
const DAY: Duration = Duration::from_secs(86_400);

/// Arguments of `grainlab topic echo`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  grainlab topic echo /stress --once\n  grainlab topic echo /packing --once --full-length --format json\n\n\
                  With --format json each message is one line, and so is the value of --field. A late reader of a latched topic gets its last messages."
)]
pub struct Args {
    /// Name of the topic
    topic: String,
    /// Type of its messages [default: that of its publishers, which are waited for]
    #[arg(value_name = "TYPE")]
    type_name: Option<String>,
    /// Print this part of each message only, as in stress.zz or estimates[0].z
    #[arg(long, value_name = "PATH")]
    field: Option<String>,
    /// Print one message and end
    #[arg(long, conflicts_with = "count")]
    once: bool,
    /// Print this many messages and end
    #[arg(short = 'n', long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    count: Option<u64>,
    /// End after this time, s
    #[arg(short, long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Print whole arrays
    #[arg(short = 'f', long)]
    full_length: bool,
    /// Print at most this many values of an array
    #[arg(short = 'l', long, value_name = "N", default_value_t = 128)]
    truncate_length: usize,
    #[command(flatten)]
    messages: MessagePath,
    #[command(flatten)]
    qos: QosArgs,
    #[command(flatten)]
    common: Common,
}

/// A part of a message as a line of JSON, then a line of hyphens.
fn part(message: &Shown<'_>, path: &str) -> Result<String, Failure> {
    let whole = serde_json::to_value(message).map_err(Failure::failed)?;
    let pointer = format!("/{}", path.replace(['.', '['], "/").replace(']', ""));
    let names =
        || whole.as_object().into_iter().flat_map(|map| map.keys().cloned()).collect::<Vec<_>>().join(", ");
    let found = whole.pointer(&pointer);
    let found = found.ok_or_else(|| {
        Failure::usage(format!("--field {path}: the message has no such part; its fields are: {}", names()))
    })?;
    Ok(format!("{found}\n---\n"))
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let given = args.type_name.as_deref().map(|given| schema(given, &args.messages)).transpose()?;
    let name = given.as_ref().map(|(name, _)| name.as_str());
    let mut listener = Listener::open(&args.topic, name, &args.qos, true, args.common.patience())?;
    let (_, schema) = given.map_or_else(|| schema(listener.topic.info.type_name, &args.messages), Ok)?;
    let longest = if args.full_length { usize::MAX } else { args.truncate_length };
    let wanted = if args.once { Some(1) } else { args.count };
    let end = Instant::now() + args.duration.map_or(DAY, Duration::from_secs_f64);
    let (mut printed, mut refused) = (0, 0_u64);
    listener.until(end, |sample| {
        match schema.decode(&sample.body) {
            Ok(message) => {
                let shown = Shown::new(&message).shortened(longest);
                let read = print_more(&match (&args.field, args.common.format) {
                    (Some(path), _) => part(&shown, path)?,
                    (None, OutputFormat::Text) => format!("{}---\n", shown.text()),
                    (None, OutputFormat::Json) => format!("{}\n", shown.json()),
                })?;
                printed += 1;
                if !read {
                    return Ok(false);
                }
            }
            Err(error) => {
                refused += 1;
                say!(
                    "grainlab: sample {} of {} does not decode: {error}",
                    sample.info.sequence,
                    sample.info.writer
                );
            }
        }
        Ok(wanted.is_none_or(|wanted| printed < wanted))
    })?;
    Ok(if refused > 0 { Exit::DataLoss } else { Exit::Done })
}
