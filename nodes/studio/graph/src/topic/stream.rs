//! Statistics of a stream of samples.

use grainlab_msgs::Guid;
use grainlab_node_kit::SampleInfo;
use serde::Serialize;
use std::collections::BTreeMap;

/// Samples of one writer in one window.
#[derive(Clone, Copy, Debug)]
struct Span {
    first: (i64, u64),
    last: (i64, u64),
    received: u64,
}

/// Messages that arrived in one window of time.
#[derive(Clone, Debug, Default)]
pub(super) struct Stream {
    writers: BTreeMap<Guid, Span>,
    bytes: u64,
    intervals: Moments,
    transport: Moments,
}

#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Moments {
    pub(super) count: u64,
    pub(super) mean: f64,
    #[serde(skip)]
    squares: f64,
    pub(super) min: f64,
    pub(super) max: f64,
}

impl Default for Moments {
    fn default() -> Self {
        Self { count: 0, mean: 0.0, squares: 0.0, min: f64::INFINITY, max: f64::NEG_INFINITY }
    }
}

impl Moments {
    /// Adds a value (Welford).
    fn add(&mut self, value: f64) {
        self.count += 1;
        let step = value - self.mean;
        self.mean += step / self.count as f64;
        self.squares += step * (value - self.mean);
        self.min = self.min.min(value);
        self.max = self.max.max(value);
    }

    pub(super) fn stddev(&self) -> f64 {
        if self.count > 1 { (self.squares / (self.count - 1) as f64).sqrt() } else { 0.0 }
    }
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct Summary {
    pub(super) received: u64,
    /// Samples that were published between the first and the last that arrived, and did not arrive here.
    pub(super) missed: u64,
    pub(super) publishers: usize,
    /// Samples published per second, by sequence numbers and times of the publishers; null with fewer than two.
    pub(super) rate_hz: Option<f64>,
    /// Bytes received per second.
    pub(super) bandwidth: Option<f64>,
    /// Mean size of a sample, bytes.
    pub(super) mean_size: Option<f64>,
    /// Time between two successive samples of a publisher, s.
    pub(super) interval: Option<Moments>,
    /// Standard deviation of that time, s.
    pub(super) interval_stddev: Option<f64>,
    /// Time from the publisher to this process, s.
    pub(super) transport: Option<Moments>,
}

impl Stream {
    pub(super) fn add(&mut self, info: &SampleInfo, bytes: usize) {
        self.bytes += bytes as u64;
        let time = info.source_time.unwrap_or(info.received);
        let now = (info.sequence, time);
        let span = self.writers.entry(info.writer).or_insert(Span { first: now, last: now, received: 0 });
        if span.received > 0 && info.sequence == span.last.0 + 1 {
            self.intervals.add(seconds_between(span.last.1, time));
        }
        span.received += 1;
        span.last = now;
        if let Some(sent) = info.source_time {
            self.transport.add(seconds_between(sent, info.received));
        }
    }

    pub(super) fn summary(&self, seconds: f64) -> Summary {
        let received: u64 = self.writers.values().map(|s| s.received).sum();
        let published: u64 = self.writers.values().map(|s| (s.last.0 - s.first.0 + 1).max(0) as u64).sum();
        let rate = |span: &Span| {
            let time = seconds_between(span.first.1, span.last.1);
            (time > 0.0).then(|| (span.last.0 - span.first.0) as f64 / time)
        };
        let rates: Vec<f64> = self.writers.values().filter_map(rate).collect();
        let some = |moments: &Moments| (moments.count > 0).then_some(*moments);
        Summary {
            received,
            missed: published.saturating_sub(received),
            publishers: self.writers.len(),
            rate_hz: (!rates.is_empty()).then(|| rates.iter().sum()),
            bandwidth: (received > 0 && seconds > 0.0).then(|| self.bytes as f64 / seconds),
            mean_size: (received > 0).then(|| self.bytes as f64 / received as f64),
            interval: some(&self.intervals),
            interval_stddev: some(&self.intervals).map(|m| m.stddev()),
            transport: some(&self.transport),
        }
    }
}

fn seconds_between(from: u64, to: u64) -> f64 {
    (i128::from(to) - i128::from(from)) as f64 * 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    fn info(writer: u8, sequence: i64, time: u64) -> SampleInfo {
        SampleInfo {
            writer: Guid([writer; 16]),
            sequence,
            source_time: Some(time),
            received: time + 50_000,
            about: None,
        }
    }

    #[test]
    fn the_rate_is_that_of_the_publishers_even_if_samples_are_missed() {
        let mut stream = Stream::default();
        // 1 kHz, of which every third arrives, and 500 Hz, of which all arrive.
        for n in (0..1000).step_by(3) {
            stream.add(&info(1, n + 7, n as u64 * 1_000_000), 100);
        }
        for n in 0..500 {
            stream.add(&info(2, n, n as u64 * 2_000_000), 100);
        }
        let found = stream.summary(1.0);
        assert!((found.rate_hz.unwrap() - 1500.0).abs() < 1e-6, "{found:?}");
        assert_eq!((found.received, found.missed, found.publishers), (834, 666, 2));
        let interval = found.interval.unwrap();
        assert!((interval.mean - 2e-3).abs() < 1e-12 && interval.count == 499);
        assert!((found.transport.unwrap().mean - 5e-5).abs() < 1e-12);
        assert_eq!(found.bandwidth, Some(83_400.0));
    }

    #[test]
    fn nothing_received_gives_no_rate() {
        let found = Stream::default().summary(1.0);
        assert!(found.rate_hz.is_none() && found.interval.is_none() && found.bandwidth.is_none());
    }
}
