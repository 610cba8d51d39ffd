//! One DDS writer of this process.

use super::direct::{CDR_BE, CDR_LE, HEADER, RawPublisher};
use crate::bus_error::BusError;
use crate::sample::SampleId;
use grainlab_msgs::{Guid, Published};
use std::collections::BTreeMap;

pub(super) struct Writer {
    pub(super) raw: RawPublisher,
    pub(super) id: Guid,
    /// Resolved name of the topic.
    pub(super) topic: String,
    window: u32,
    count: u64,
    full: u64,
    /// Messages of other topics that were sent in parts.
    wholes: BTreeMap<String, u64>,
}

impl Writer {
    /// A writer of a resolved topic; at most `window` samples may be unacknowledged.
    pub(super) fn new(raw: RawPublisher, topic: String, window: u32) -> Self {
        let id = raw.guid();
        let (count, full, wholes) = Default::default();
        Self { raw, id, topic, window, count, full, wholes }
    }

    /// Publishes a body with its encapsulation header and returns the sequence number.
    pub(super) fn write(&mut self, body: &[u8], about: Option<SampleId>) -> Result<i64, BusError> {
        if body.len() < HEADER || ![CDR_LE, CDR_BE].contains(&[body[0], body[1]]) {
            let found = body[..body.len().min(HEADER)].to_vec();
            return Err(BusError::Encapsulation { topic: self.topic.clone(), found });
        }
        let failed = |reason| BusError::Network { what: format!("publish {}", self.topic), reason };
        let Some(sequence) = self.raw.write(body, about).map_err(failed)? else {
            self.full += 1;
            return Err(BusError::Full { topic: self.topic.clone(), window: self.window });
        };
        self.count += 1;
        Ok(sequence)
    }

    /// Counts one message of the resolved topic `whole` that was sent in parts.
    pub(super) fn count_whole(&mut self, whole: String) {
        *self.wholes.entry(whole).or_default() += 1;
    }

    /// Statistics: messages sent in parts come before its own.
    pub(super) fn published(&self) -> Vec<Published> {
        let writer = self.id;
        let whole = |(topic, count): (&String, &u64)| Published {
            topic: topic.clone(),
            writer,
            count: *count,
            full: 0,
        };
        let own = Published { topic: self.topic.clone(), writer, count: self.count, full: self.full };
        self.wholes.iter().map(whole).chain([own]).collect()
    }
}
