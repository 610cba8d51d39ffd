//! Times and intervals on the command line.

use grainlab_console::Failure;
use grainlab_recordings::Recording;
use std::str::FromStr;

/// A log time, ns since 1970.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Time(pub(crate) u64);

impl FromStr for Time {
    type Err = String;

    /// Seconds since 1970 with up to nine decimal places, or a date and time with its zone.
    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(ns) = seconds(text) {
            return Ok(Self(ns));
        }
        let stamp = chrono::DateTime::parse_from_rfc3339(text).ok();
        let ns = stamp.and_then(|t| u64::try_from(t.timestamp_nanos_opt()?).ok());
        ns.map(Self).ok_or_else(|| {
            format!(
                "{text:?} is not a time: write seconds since 1970 (1700000000.5) or 2026-01-31T12:00:00.5Z"
            )
        })
    }
}

/// Decimal seconds as nanoseconds, without the rounding of a binary number.
fn seconds(text: &str) -> Option<u64> {
    let (whole, part) = text.split_once('.').unwrap_or((text, ""));
    let digits = |t: &str| t.bytes().all(|b| b.is_ascii_digit());
    if whole.is_empty() || !digits(whole) || !digits(part) || part.len() > 9 {
        return None;
    }
    let part: u64 = format!("{part:0<9}").parse().ok()?;
    whole.parse::<u64>().ok()?.checked_mul(1_000_000_000)?.checked_add(part)
}

/// An interval of log time.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct Interval {
    /// First log time: seconds since 1970, or 2026-01-31T12:00:00Z
    #[arg(long, value_name = "TIME", conflicts_with = "start_offset")]
    start: Option<Time>,
    /// Log time before which to end
    #[arg(long, value_name = "TIME", conflicts_with = "duration")]
    end: Option<Time>,
    /// Start, s after the first message
    #[arg(long, value_name = "S")]
    start_offset: Option<f64>,
    /// Duration, s from the start
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
}

impl Interval {
    /// First log time, and the one before which to end, ns since 1970.
    pub(crate) fn of(&self, recordings: &[Recording]) -> Result<(Option<u64>, Option<u64>), Failure> {
        let ns = |name: &str, s: Option<f64>| match s {
            Some(s) if !(0.0..1e9).contains(&s) => {
                Err(Failure::usage(format!("--{name} {s} is out of range: 0 to 1e9 seconds")))
            }
            s => Ok(s.map(|s| (s * 1e9).round() as u64)),
        };
        let (offset, duration) = (ns("start-offset", self.start_offset)?, ns("duration", self.duration)?);
        let ranges = || recordings.iter().filter_map(Recording::time_range);
        let first = ranges().map(|(first, _)| first).min().unwrap_or(0);
        let last = ranges().map(|(_, last)| last).max().unwrap_or(u64::MAX);
        let start = self.start.map(|t| t.0).or(offset.map(|o| first.saturating_add(o)));
        let length = duration.map(|d| start.unwrap_or(first).saturating_add(d));
        let end = self.end.map(|t| t.0).or(length);
        match (start, end) {
            (Some(start), Some(end)) if end < start => Err(Failure::usage("the end is before the start")),
            (Some(start), _) if start > last => Err(Failure::usage(format!(
                "the start is after the end: the recording has {} s",
                (last - first) as f64 * 1e-9
            ))),
            (_, Some(end)) if end <= first => {
                Err(Failure::usage("the end is before the first message of the recording"))
            }
            interval => Ok(interval),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_exact_to_the_nanosecond() {
        let of = |text: &str| text.parse::<Time>().map(|t| t.0);
        assert_eq!(of("1700000000.123456789"), Ok(1_700_000_000_123_456_789));
        assert_eq!(of("1700000000"), Ok(1_700_000_000_000_000_000));
        assert_eq!(of("2023-11-14T22:13:20.5Z"), Ok(1_700_000_000_500_000_000));
        assert_eq!(of("2023-11-14T23:13:20+01:00"), Ok(1_700_000_000_000_000_000));
        for wrong in ["", "-1", "1.0000000001", "1e9", "yesterday", "99999999999999"] {
            assert!(of(wrong).is_err(), "{wrong}");
        }
    }
}
