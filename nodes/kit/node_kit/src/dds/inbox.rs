//! One DDS reader and the samples that were read from it but not taken yet.

use super::direct::{RawSubscription, TakeFailure, wall_nanos};
use crate::bus_error::BusError;
use crate::demand::Demand;
use crate::sample::{Sample, SampleId, SampleInfo};
use std::collections::VecDeque;

/// Most bytes of the samples that are queued beyond the depth of a reader that takes bursts.
const BURST_BYTES: usize = 64 << 20;

/// Samples that were read, the oldest first.
#[derive(Default)]
struct Queue {
    samples: VecDeque<Sample>,
    bytes: usize,
}

impl Queue {
    /// Adds a sample; a full queue drops its oldest ones.
    fn push(&mut self, sample: Sample, demand: Demand) {
        self.bytes += size_of(&sample);
        self.samples.push_back(sample);
        let takes_bursts = demand.burst > demand.depth;
        while self.samples.len() > demand.depth as usize && !(takes_bursts && self.bytes <= BURST_BYTES) {
            self.pop();
        }
    }

    fn pop(&mut self) -> Option<Sample> {
        let sample = self.samples.pop_front()?;
        self.bytes -= size_of(&sample);
        Some(sample)
    }
}

fn size_of(sample: &Sample) -> usize {
    std::mem::size_of::<Sample>() + sample.body.capacity()
}

pub(super) struct Inbox {
    pub(super) reader: RawSubscription,
    topic: String,
    pub(super) demand: Demand,
    queue: Queue,
    /// Our own participant: the bus delivers its samples, and the copies from DDS are dropped.
    own: [u8; 12],
    /// Number of samples that RustDDS could not return: their representation is not CDR.
    pub(super) refused: u64,
}

impl Inbox {
    pub(super) fn new(reader: RawSubscription, topic: String, demand: Demand, own: [u8; 12]) -> Self {
        Self { reader, topic, demand, queue: Queue::default(), own, refused: 0 }
    }

    /// Adds a sample that this process published: a participant without multicast does not discover itself, and DDS would
    /// not deliver its own samples.
    pub(super) fn deliver_own(&mut self, id: SampleId, about: Option<SampleId>, body: &[u8]) {
        // Samples that others published before come before it. The node's next take returns the error of a failing reader.
        let _ = self.collect();
        let SampleId { writer, sequence } = id;
        let now = wall_nanos();
        let info = SampleInfo { writer, sequence, source_time: Some(now), received: now, about };
        self.queue.push(Sample { body: body.to_vec(), info }, self.demand);
    }

    pub(super) fn has_data(&self) -> bool {
        !self.queue.samples.is_empty()
    }

    pub(super) fn take(&mut self) -> Result<Option<Sample>, BusError> {
        match self.queue.pop() {
            Some(sample) => Ok(Some(sample)),
            None => self.read(),
        }
    }

    /// Moves all samples that arrived into the queue; true if there were any.
    pub(super) fn collect(&mut self) -> Result<bool, BusError> {
        self.reader.acknowledge();
        let mut moved = false;
        while let Some(sample) = self.read()? {
            moved = true;
            self.queue.push(sample, self.demand);
        }
        Ok(moved)
    }

    fn read(&mut self) -> Result<Option<Sample>, BusError> {
        loop {
            match self.reader.take() {
                Ok(Some(sample)) if sample.info.writer.participant() == self.own => {}
                Ok(sample) => return Ok(sample),
                Err(TakeFailure::Representation(reason)) => {
                    self.refused += 1;
                    log::warn!("{}: sample refused: {reason}", self.topic);
                }
                Err(TakeFailure::Other(reason)) => {
                    return Err(BusError::Network { what: format!("read {}", self.topic), reason });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of the samples that are left of `count` samples of `size` bytes.
    fn kept(demand: Demand, count: i64, size: usize) -> Vec<i64> {
        let mut queue = Queue::default();
        for sequence in 1..=count {
            let info = SampleInfo {
                writer: Default::default(),
                sequence,
                source_time: None,
                received: 0,
                about: None,
            };
            queue.push(Sample { body: vec![0; size], info }, demand);
        }
        let kept = std::iter::from_fn(|| queue.pop()).map(|sample| sample.info.sequence).collect();
        assert_eq!(queue.bytes, 0);
        kept
    }

    #[test]
    fn a_full_queue_drops_the_oldest_and_one_for_bursts_is_full_by_its_bytes() {
        let demand = Demand::reliable(3);
        assert_eq!(kept(demand, 5, 10), [3, 4, 5]);
        let burst = demand.with_burst(4);
        assert_eq!(kept(burst, 20_000, 10).len(), 20_000);
        assert_eq!(kept(burst, 20, BURST_BYTES / 4), [18, 19, 20], "at least the depth");
        assert_eq!(kept(burst, 20, BURST_BYTES / 10).len(), 9);
    }
}
