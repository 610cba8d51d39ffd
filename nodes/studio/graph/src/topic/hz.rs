//! `grainlab topic hz`: a line each second, or one result after a fixed time.

use super::listen::Listener;
use super::qos::QosArgs;
use super::stream::{Stream, Summary};
use crate::view::{Common, OutputFormat, seconds};
use grainlab_console::{Failure, count, print_more};
use grainlab_node_kit::Exit;
use std::time::{Duration, Instant};

/// Arguments of `grainlab topic hz`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  grainlab topic hz /stress --duration 5\n\nThe rate follows from the publishers' sequence \
                  numbers and times: it is right even if this process\nreceives a part of the samples only. --format json \
                  has the bandwidth and the time from the publisher to this process, too."
)]
pub struct Args {
    /// Name of the topic
    topic: String,
    /// Measure for this time and print one result, s [default: a line each second until Ctrl-C]
    #[arg(short, long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    duration: Option<f64>,
    #[command(flatten)]
    common: Common,
}

fn line(s: &Summary) -> String {
    let Some(rate) = s.rate_hz else {
        return format!("{}: too few to measure", count(s.received, "sample"));
    };
    let interval = s.interval.map_or_else(String::new, |i| {
        let [min, max, deviation] = [i.min, i.max, s.interval_stddev.unwrap_or(0.0)].map(|v| 1e3 * v);
        format!("; interval {min:.3} to {max:.3} ms, std dev {deviation:.3} ms")
    });
    let missed =
        if s.missed > 0 { format!("; {} of them not received here", s.missed) } else { String::new() };
    let publishers =
        if s.publishers > 1 { format!(" of {} publishers", s.publishers) } else { String::new() };
    format!("{rate:.3} Hz{publishers}, {} samples{missed}{interval}", s.received + s.missed)
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let patience = args.common.patience();
    let mut listener = Listener::open(&args.topic, None, &QosArgs::default(), false, patience)?;
    let each = Duration::from_secs_f64(args.duration.unwrap_or(1.0));
    listener.wait_for_publisher(patience)?;
    let (mut stream, mut begin) = (Stream::default(), Instant::now());
    loop {
        listener.until(Instant::now() + each, |sample| {
            stream.add(&sample.info, sample.body.len());
            Ok(true)
        })?;
        let summary = stream.summary(begin.elapsed().as_secs_f64());
        let read = match args.common.format {
            OutputFormat::Text => print_more(&format!("{}\n", line(&summary)))?,
            OutputFormat::Json => {
                let text = serde_json::to_string(&summary).map_err(Failure::failed)?;
                print_more(&format!("{text}\n"))?
            }
        };
        if args.duration.is_some() || !read {
            return Ok(Exit::Done);
        }
        // A topic slower than once a second needs a longer window.
        if summary.rate_hz.is_some() {
            (stream, begin) = (Stream::default(), Instant::now());
        }
    }
}
