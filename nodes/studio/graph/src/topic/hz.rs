//! `grainlab topic hz`, `bw` and `delay`: a line each second, or one result after a fixed time.

use super::listen::Listener;
use super::qos::QosArgs;
use super::stream::{Stream, Summary};
use crate::view::{Common, OutputFormat, seconds};
use grainlab_console::{Failure, count, fixed, print_more};
use grainlab_msgs::TypeInfo;
use grainlab_node_kit::Exit;
use std::time::{Duration, Instant};

/// Bytes of the encapsulation header of a sample.
const ENCAPSULATION: usize = 4;

/// Stamps before 2017, ns since 1970, are simulated times.
const WALL_TIME: u64 = 1_500_000_000_000_000_000;

/// Arguments of all three.
#[derive(Debug, clap::Args)]
pub struct Window {
    /// Name of the topic
    topic: String,
    /// Measure for this time and print one result, s [default: a line each second until Ctrl-C]
    #[arg(short, long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Print a line after this many messages, not each second
    #[arg(short, long, value_name = "N", conflicts_with = "duration", value_parser = clap::value_parser!(u64).range(2..))]
    window: Option<u64>,
    #[command(flatten)]
    common: Common,
}

pub(super) fn rate_line(s: &Summary) -> String {
    let Some(rate) = s.rate_hz else { return few(s) };
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

pub(super) fn bandwidth_line(s: &Summary) -> String {
    let (Some(rate), Some(size)) = (s.bandwidth, s.mean_size) else { return few(s) };
    format!("{:.1} kB/s, {} samples of {size:.0} bytes on average", rate / 1e3, s.received)
}

pub(super) fn delay_line(s: &Summary) -> String {
    if s.received == 0 {
        return few(s);
    }
    let micros = |m: super::stream::Moments| {
        let [mean, min, max] = [m.mean, m.min, m.max].map(|v| fixed(Some(1e6 * v), 1));
        format!("{mean} us on average, {min} to {max} us")
    };
    let age = s.age.map_or_else(String::new, |age| format!("; age of the stamps {}", micros(age)));
    let transport = s.transport.map_or_else(
        || " without a time of publishing".to_owned(),
        |transport| format!(", from the publisher to here {}", micros(transport)),
    );
    format!("{}{transport}{age}", count(s.received, "sample"))
}

fn few(s: &Summary) -> String {
    format!("{}: too few to measure", count(s.received, "sample"))
}

pub(super) fn measure(window: &Window, line: fn(&Summary) -> String) -> Result<Exit, Failure> {
    let mut listener =
        Listener::open(&window.topic, None, &QosArgs::default(), false, window.common.patience())?;
    let stamped = begins_with_header(listener.topic.info.type_name);
    let each = Duration::from_secs_f64(window.duration.unwrap_or(if window.window.is_some() {
        86_400.0
    } else {
        1.0
    }));
    listener.wait_for_publisher(window.common.patience())?;
    let (mut stream, mut begin) = (Stream::default(), Instant::now());
    loop {
        listener.until(Instant::now() + each, |sample| {
            let stamp = stamped.then(|| header_stamp(&sample.body)).flatten();
            stream.add(&sample.info, sample.body.len(), stamp);
            Ok(window.window.is_none_or(|most| stream.received() < most))
        })?;
        let summary = stream.summary(begin.elapsed().as_secs_f64());
        let read = match window.common.format {
            OutputFormat::Text => print_more(&format!("{}\n", line(&summary)))?,
            OutputFormat::Json => {
                let text = serde_json::to_string(&summary).map_err(Failure::failed)?;
                print_more(&format!("{text}\n"))?
            }
        };
        if window.duration.is_some() || !read {
            return Ok(Exit::Done);
        }
        // A topic slower than once a second needs a longer window.
        if summary.rate_hz.is_some() {
            (stream, begin) = (Stream::default(), Instant::now());
        }
    }
}

/// True for a type, among those that this program knows, whose messages begin with a `std_msgs/Header`.
fn begins_with_header(type_name: &str) -> bool {
    TypeInfo::by_name(type_name).is_some_and(|info| {
        let mut lines = info.definition.lines().map(|l| l.split('#').next().unwrap_or("").trim());
        lines.find(|line| !line.is_empty()).is_some_and(|line| line.starts_with("std_msgs/Header "))
    })
}

/// The stamp of a little-endian body that begins with a header, ns since 1970; `None` for simulated time.
fn header_stamp(body: &[u8]) -> Option<u64> {
    let word = |at: usize| Some(u32::from_le_bytes(body.get(at..at + 4)?.try_into().ok()?));
    let nanos = u64::from(word(ENCAPSULATION)?) * 1_000_000_000 + u64::from(word(ENCAPSULATION + 4)?);
    (nanos > WALL_TIME).then_some(nanos)
}
