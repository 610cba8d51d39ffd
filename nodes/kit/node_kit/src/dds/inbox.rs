//! One DDS reader and the samples that were read from it but not taken yet.

use super::direct::{RawSubscription, TakeFailure};
use crate::bus_error::BusError;
use crate::demand::Demand;
use crate::sample::{Sample, SampleId, SampleInfo};
use crate::wall_clock::wall_nanos;
use std::collections::VecDeque;

/// A reader shared by all subscriptions to its topic, with one queue per subscription.
pub(super) struct Inbox {
    pub(super) reader: RawSubscription,
    topic: String,
    pub(super) demand: Demand,
    /// One for each subscriber; that of one that left is `None`.
    queues: Vec<Option<VecDeque<Sample>>>,
    /// Our own participant: the bus delivers its samples, and the copies from DDS are dropped.
    own: [u8; 12],
    /// Number of samples that RustDDS could not return: their representation is not CDR.
    pub(super) refused: u64,
}

impl Inbox {
    pub(super) fn new(reader: RawSubscription, topic: String, demand: Demand, own: [u8; 12]) -> Self {
        Self { reader, topic, demand, queues: Vec::new(), own, refused: 0 }
    }

    /// Adds a sample that this process published: a participant without multicast does not discover itself, and DDS would
    /// not deliver its own samples.
    pub(super) fn deliver_own(&mut self, id: SampleId, about: Option<SampleId>, body: &[u8]) {
        // Samples that others published before come before it. The node's next take returns the error of a failing reader.
        let _ = self.collect();
        let SampleId { writer, sequence } = id;
        let now = wall_nanos();
        let info = SampleInfo { writer, sequence, source_time: Some(now), received: now, about };
        let sample = Sample { body: body.to_vec(), info };
        for queue in self.queues.iter_mut().flatten() {
            push_bounded(queue, sample.clone(), self.demand.depth);
        }
    }

    /// Adds a subscriber and returns its index.
    pub(super) fn add_queue(&mut self) -> usize {
        self.queues.push(Some(VecDeque::new()));
        self.queues.len() - 1
    }

    /// Removes a subscriber.
    pub(super) fn close_queue(&mut self, place: usize) {
        self.queues[place] = None;
    }

    pub(super) fn has_data(&self) -> bool {
        self.queues.iter().flatten().any(|queue| !queue.is_empty())
    }

    /// The next sample for one subscriber.
    pub(super) fn take(&mut self, place: usize) -> Result<Option<Sample>, BusError> {
        if let Some(sample) = self.queues[place].as_mut().and_then(VecDeque::pop_front) {
            return Ok(Some(sample));
        }
        // With one subscriber a sample is returned directly; with more, it is also queued for the others.
        let Some(sample) = self.read()? else { return Ok(None) };
        for (other, queue) in self.queues.iter_mut().enumerate() {
            if let Some(queue) = queue.as_mut().filter(|_| other != place) {
                push_bounded(queue, sample.clone(), self.demand.depth);
            }
        }
        Ok(Some(sample))
    }

    /// Moves all samples that arrived into the queues; true if there were any.
    pub(super) fn collect(&mut self) -> Result<bool, BusError> {
        self.reader.acknowledge();
        let mut moved = false;
        while let Some(sample) = self.read()? {
            moved = true;
            let mut queues: Vec<&mut VecDeque<Sample>> = self.queues.iter_mut().flatten().collect();
            if let Some((last, others)) = queues.split_last_mut() {
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

/// Queues a sample; a full queue drops its oldest one.
fn push_bounded(queue: &mut VecDeque<Sample>, sample: Sample, depth: u32) {
    if queue.len() >= depth as usize {
        queue.pop_front();
    }
    queue.push_back(sample);
}
