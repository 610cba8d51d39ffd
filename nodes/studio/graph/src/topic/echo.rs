//! `grainlab topic echo`.

use super::listen::Listener;
use crate::view::{Common, OutputFormat, seconds};
use grainlab_any_message::{Schema, Shown};
use grainlab_console::{Failure, print_more, say};
use grainlab_node_kit::Exit;
use grainlab_recordings::Definitions;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// A day: as good as no limit.
const DAY: Duration = Duration::from_secs(86_400);

/// Arguments of `grainlab topic echo`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  grainlab topic echo /stress --once\n  grainlab topic echo /packing --once --full-length --format json\n\n\
                  With --format json each message is one line. A late reader of a latched topic gets its last messages."
)]
pub struct Args {
    /// Name of the topic
    topic: String,
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
    /// Folder with message files, package/msg/Type.msg
    #[arg(long, value_name = "DIR")]
    msg_path: Vec<PathBuf>,
    #[command(flatten)]
    common: Common,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let mut listener = Listener::open(&args.topic, true, args.common.patience())?;
    let type_name = listener.topic.info.type_name;
    let text = Definitions::with_folders(&args.msg_path).text(type_name, "").map_err(Failure::failed)?;
    let schema = Schema::parse(type_name, &text).map_err(Failure::failed)?;
    let longest = if args.full_length { usize::MAX } else { args.truncate_length };
    let wanted = if args.once { Some(1) } else { args.count };
    let end = Instant::now() + args.duration.map_or(DAY, Duration::from_secs_f64);
    let (mut printed, mut refused) = (0, 0_u64);
    listener.until(end, |sample| {
        match schema.decode(&sample.body) {
            Ok(message) => {
                let shown = Shown::new(&message).shortened(longest);
                let read = print_more(&match args.common.format {
                    OutputFormat::Text => format!("{}---\n", shown.text()),
                    OutputFormat::Json => format!("{}\n", shown.json()),
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
