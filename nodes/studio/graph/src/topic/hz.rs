//! `grainlab topic hz`, `bw` and `delay`: a line each second, or one result after a fixed time.

use super::listen::Listener;
use super::qos::QosArgs;
use super::stream::{Stream, Summary};
use crate::view::{Common, OutputFormat, schema, seconds};
use grainlab_any_message::{Element, Length, Schema};
use grainlab_console::{Failure, count, fixed, print_more};
use grainlab_node_kit::Exit;
use grainlab_recordings::MessagePath;
use std::time::{Duration, Instant};

/// Bytes of the encapsulation header of a sample.
const ENCAPSULATION: usize = 4;

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
    let mut age = s.age.map_or_else(String::new, |age| format!("; age of the stamps {}", micros(age)));
    if s.simulated > 0 {
        let stamps = count(s.simulated, "stamp");
        age += &format!("; {stamps} before 2017: simulated or not set, so no age");
    } else if age.is_empty() {
        age += "; no age: the type is not known to begin with a std_msgs/Header";
    }
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
    let schema = schema(listener.topic.info.type_name, &MessagePath::default());
    let stamped = schema.is_ok_and(|(_, schema)| begins_with_header(&schema));
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

/// True for a type whose messages begin with a `std_msgs/Header`.
fn begins_with_header(schema: &Schema) -> bool {
    let is_header = |element: &Element| matches!(element, Element::Message(m) if m.name == "std_msgs/Header");
    let first = schema.root().fields.first().map(|field| &field.kind);
    first.is_some_and(|kind| kind.length == Length::One && is_header(&kind.element))
}

/// The stamp of a body in CDR that begins with a header, ns since 1970.
fn header_stamp(body: &[u8]) -> Option<u64> {
    let word = |at: usize| {
        let bytes = body.get(at..at + 4)?.try_into().ok()?;
        Some(if body[1] == 0 { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    };
    Some(u64::from(word(ENCAPSULATION)?) * 1_000_000_000 + u64::from(word(ENCAPSULATION + 4)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_node_kit::SampleInfo;

    #[test]
    fn a_delay_has_an_age_by_wall_time_and_says_why_not_by_other_stamps() {
        let of = |name| begins_with_header(&schema(name, &MessagePath::default()).unwrap().1);
        assert!(of("grainlab_msgs/msg/Stress") && of("sensor_msgs/msg/Imu") && !of("std_msgs/msg/String"));
        let body =
            |[sec, nanosec]: [u32; 2]| [[0, 1, 0, 0], sec.to_le_bytes(), nanosec.to_le_bytes()].concat();
        let big_endian = [[0; 4], 7_u32.to_be_bytes(), 5_u32.to_be_bytes()].concat();
        assert_eq!(header_stamp(&big_endian), Some(7_000_000_005));
        let info = SampleInfo {
            writer: grainlab_msgs::Guid([1; 16]),
            sequence: 1,
            source_time: None,
            received: 1_800_000_000_000_250_000,
            about: None,
        };
        let line = |stamp: Option<Vec<u8>>| {
            let mut stream = Stream::default();
            stream.add(&info, 8, stamp.and_then(|body| header_stamp(&body)));
            delay_line(&stream.summary(1.0))
        };
        assert!(
            line(Some(body([1_800_000_000, 0])))
                .ends_with("age of the stamps 250.0 us on average, 250.0 to 250.0 us")
        );
        assert!(line(Some(body([12, 0]))).ends_with("1 stamp before 2017: simulated or not set, so no age"));
        assert!(line(None).contains("no age: the type"));
    }
}
