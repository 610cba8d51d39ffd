//! One DDS writer of this process.

use super::direct::{CDR_BE, CDR_LE, HEADER, Outlet, WriteFailure};
use super::lock::lock;
use crate::bus_error::BusError;
use crate::sample::SampleId;
use grainlab_msgs::{Guid, Published};
use ros2_client::Gid;
use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// A writer and its statistics. One thread at a time may write.
pub(super) struct Writer {
    pub(super) outlet: Outlet,
    pub(super) gid: Gid,
    /// Resolved name.
    pub(super) topic: String,
    window: u32,
    count: AtomicU64,
    full: AtomicU64,
    /// Messages of other topics that were sent in parts.
    wholes: Mutex<BTreeMap<String, u64>>,
}

impl Writer {
    /// A writer of a resolved topic; at most `window` samples may be unacknowledged.
    pub(super) fn new(outlet: Outlet, topic: String, window: u32) -> Self {
        let gid = outlet.gid();
        let (count, full, wholes) = Default::default();
        Self { outlet, gid, topic, window, count, full, wholes }
    }

    pub(super) fn id(&self) -> Guid {
        Guid(self.gid.to_bytes16())
    }

    /// Publishes a body with its encapsulation header and returns the sequence number.
    pub(super) fn write(&self, body: &[u8], about: Option<SampleId>) -> Result<i64, BusError> {
        if body.len() < HEADER || ![CDR_LE, CDR_BE].contains(&[body[0], body[1]]) {
            let found = body[..body.len().min(HEADER)].to_vec();
            return Err(BusError::Encapsulation { topic: self.topic.clone(), found });
        }
        match self.outlet.write(body, about) {
            Ok(sequence) => {
                self.count.fetch_add(1, Ordering::Relaxed);
                Ok(sequence)
            }
            Err(WriteFailure::Full) => {
                self.full.fetch_add(1, Ordering::Relaxed);
                Err(BusError::Full { topic: self.topic.clone(), window: self.window })
            }
            Err(WriteFailure::Other(reason)) => {
                Err(BusError::Network { what: format!("publish {}", self.topic), reason })
            }
        }
    }

    /// Counts one message of the resolved topic `whole` that was sent in parts.
    pub(super) fn count_whole(&self, whole: String) {
        *lock(&self.wholes).entry(whole).or_default() += 1;
    }

    /// Its statistics: messages sent in parts come before its own.
    pub(super) fn published(&self) -> Vec<Published> {
        let writer = self.id();
        let whole = |(topic, count): (&String, &u64)| Published {
            topic: topic.clone(),
            writer,
            count: *count,
            full: 0,
        };
        let [count, full] = [&self.count, &self.full].map(|n| n.load(Ordering::Relaxed));
        let own = Published { topic: self.topic.clone(), writer, count, full };
        lock(&self.wholes).iter().map(whole).chain([own]).collect()
    }
}
