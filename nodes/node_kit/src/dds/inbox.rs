//! One DDS reader and the samples that were read from it but not taken yet.

use super::raw::{RawAdapter, RawBody};
use crate::bus_error::BusError;
use crate::demand::Demand;
use crate::sample::{Sample, SampleId, SampleInfo, WriterId};
use rustdds::no_key::{DeserializedCacheChange, SimpleDataReader};
use rustdds::{GUID, Timestamp};
use std::collections::VecDeque;

pub(super) type RawReader = SimpleDataReader<RawBody, RawAdapter>;

/// A reader shared by all subscriptions to its topic, with one queue per subscription.
pub(super) struct Inbox {
    reader: RawReader,
    topic: String,
    demand: Demand,
    queues: Vec<VecDeque<Sample>>,
    /// Our own participant: the bus delivers its samples, and the copies from DDS are dropped.
    own: [u8; 12],
    /// Number of samples that RustDDS could not return: their representation is not CDR.
    refused: u64,
}

impl Inbox {
    pub(super) fn new(reader: RawReader, topic: String, demand: Demand, own: [u8; 12]) -> Self {
        Self { reader, topic, demand, queues: Vec::new(), own, refused: 0 }
    }

    /// Adds a sample that did not come through DDS.
    pub(super) fn deliver(&mut self, sample: Sample) {
        for queue in &mut self.queues {
            push_bounded(queue, sample.clone(), self.demand.depth);
        }
    }

    pub(super) fn guid(&self) -> GUID {
        self.reader.guid()
    }

    pub(super) fn demand(&self) -> Demand {
        self.demand
    }

    pub(super) fn reader_mut(&mut self) -> &mut RawReader {
        &mut self.reader
    }

    /// Adds a subscriber and returns its index.
    pub(super) fn add_queue(&mut self) -> usize {
        self.queues.push(VecDeque::new());
        self.queues.len() - 1
    }

    pub(super) fn has_data(&self) -> bool {
        self.queues.iter().any(|queue| !queue.is_empty())
    }

    pub(super) fn refused(&self) -> u64 {
        self.refused
    }

    /// Clears the reader's notification, so that the next sample raises a new one. Before reading, never after.
    pub(super) fn acknowledge(&self) {
        self.reader.drain_read_notifications();
    }

    /// The next sample for one subscriber.
    pub(super) fn take(&mut self, place: usize) -> Result<Option<Sample>, BusError> {
        if let Some(sample) = self.queues[place].pop_front() {
            return Ok(Some(sample));
        }
        // With one subscriber a sample is returned directly; with more, it is also queued for the others.
        let Some(sample) = self.read()? else { return Ok(None) };
        for (other, queue) in self.queues.iter_mut().enumerate() {
            if other != place {
                push_bounded(queue, sample.clone(), self.demand.depth);
            }
        }
        Ok(Some(sample))
    }

    /// Moves all samples that arrived into the queues; true if there were any.
    pub(super) fn collect(&mut self) -> Result<bool, BusError> {
        self.acknowledge();
        let mut moved = false;
        while let Some(sample) = self.read()? {
            moved = true;
            if let Some((last, others)) = self.queues.split_last_mut() {
                for queue in others {
                    push_bounded(queue, sample.clone(), self.demand.depth);
                }
                push_bounded(last, sample, self.demand.depth);
            }
        }
        Ok(moved)
    }

    fn read(&mut self) -> Result<Option<Sample>, BusError> {
        loop {
            match self.reader.try_take_one() {
                Ok(Some(change)) if WriterId(change.writer_guid.to_bytes()).participant() == self.own => {}
                Ok(change) => return Ok(change.map(sample)),
                Err(rustdds::dds::ReadError::Deserialization { reason }) => {
                    self.refused += 1;
                    log::warn!("{}: sample refused: {reason}", self.topic);
                }
                Err(error) => {
                    return Err(BusError::Network {
                        what: format!("read {}", self.topic),
                        reason: error.to_string(),
                    });
                }
            }
        }
    }
}

/// Queues a sample; a full queue drops its oldest one.
fn push_bounded(queue: &mut VecDeque<Sample>, sample: Sample, depth: u32) {
    if queue.len() >= depth as usize {
        queue.pop_front();
    }
    queue.push_back(sample);
}

fn sample(change: DeserializedCacheChange<RawBody>) -> Sample {
    let info = SampleInfo {
        writer: WriterId(change.writer_guid.to_bytes()),
        sequence: i64::from(change.sequence_number),
        source_time: change.source_timestamp().filter(|t| *t != Timestamp::INVALID).map(nanos),
        received: nanos(change.receive_instant),
        about: change.related_sample_identity().map(|sample| SampleId {
            writer: WriterId(sample.writer_guid.to_bytes()),
            sequence: i64::from(sample.sequence_number),
        }),
    };
    Sample { body: change.into_value().0, info }
}

/// An RTPS time (2⁻³² s since 1970) in nanoseconds.
fn nanos(time: Timestamp) -> u64 {
    let ticks = time.to_ticks();
    let fraction = ((ticks & 0xffff_ffff) * 1_000_000_000 + (1 << 31)) >> 32;
    (ticks >> 32) * 1_000_000_000 + fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rtps_ticks_become_nanoseconds_to_half_a_tick() {
        for (ticks, expected) in [(0, 0), (1 << 32, 1_000_000_000), ((5 << 32) | (1 << 31), 5_500_000_000)] {
            assert_eq!(nanos(Timestamp::from_ticks(ticks)), expected);
        }
    }
}
