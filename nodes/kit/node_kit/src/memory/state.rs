//! The state of a network in memory: time, writers and readers.

use super::faults::{Dice, Faults};
use super::time::Time;
use crate::admission::Participant;
use crate::demand::Demand;
use crate::sample::{Sample, SampleId, SampleInfo};
use grainlab_msgs::{Guid, Qos, Topic};
use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

#[derive(Debug)]
pub(super) struct MemoryState {
    pub(super) time: Time,
    dice: Dice,
    pub(super) faults: BTreeMap<String, Faults>,
    pub(super) participants: u32,
    pub(super) writers: Vec<Writer>,
    pub(super) readers: Vec<Reader>,
}

#[derive(Debug)]
pub(super) struct Writer {
    pub(super) id: Guid,
    pub(super) topic: String,
    pub(super) type_name: &'static str,
    pub(super) qos: Qos,
    pub(super) count: u64,
    latched: VecDeque<Sample>,
    pub(super) alive: bool,
}

#[derive(Debug)]
pub(super) struct Reader {
    pub(super) participant: Participant,
    pub(super) topic: String,
    pub(super) demand: Demand,
    /// Due time and sample, in the order of due time.
    queue: VecDeque<(Duration, Sample)>,
    pub(super) taken: u64,
    pub(super) refused: u64,
    pub(super) alive: bool,
}

pub(super) fn writer_id(participant: Participant, entity: usize) -> Guid {
    let mut bytes = [0; 16];
    bytes[..12].copy_from_slice(&participant);
    bytes[12..].copy_from_slice(&(entity as u32).to_be_bytes());
    Guid(bytes)
}

impl MemoryState {
    pub(super) fn new(seed: u64, time: Time) -> Self {
        Self {
            time,
            dice: Dice::new(seed),
            faults: BTreeMap::new(),
            participants: 0,
            writers: Vec::new(),
            readers: Vec::new(),
        }
    }

    pub(super) fn next_arrival(&self) -> Option<Duration> {
        let now = self.time.transit;
        let next = |r: &Reader| r.queue.iter().map(|(due, _)| *due).find(|due| *due > now);
        self.readers.iter().filter(|r| r.alive).filter_map(next).min()
    }

    pub(super) fn add_writer(&mut self, participant: Participant, topic: String, of: &Topic) -> usize {
        let id = writer_id(participant, self.writers.len());
        let (qos, type_name) = (of.qos, of.info.type_name);
        let latched = VecDeque::new();
        self.writers.push(Writer { id, topic, type_name, qos, count: 0, latched, alive: true });
        self.writers.len() - 1
    }

    pub(super) fn add_reader(&mut self, participant: Participant, topic: String, demand: Demand) -> usize {
        let mut queue = VecDeque::new();
        if demand.reliable {
            let now = self.time.transit;
            for writer in self.writers.iter().filter(|w| w.alive && w.topic == topic) {
                queue.extend(writer.latched.iter().map(|sample| (now, sample.clone())));
            }
        }
        self.readers.push(Reader { participant, topic, demand, queue, taken: 0, refused: 0, alive: true });
        self.readers.len() - 1
    }

    pub(super) fn publish(&mut self, writer: usize, body: &[u8], about: Option<SampleId>) -> i64 {
        let (now, received) = (self.time.transit, self.time.wall_nanos());
        let writer = &mut self.writers[writer];
        writer.count += 1;
        let info = SampleInfo {
            writer: writer.id,
            sequence: writer.count as i64,
            source_time: Some(received),
            received,
            about,
        };
        // RTPS pads a sample to four bytes: the same bytes are recorded from every bus.
        let length = body.len().next_multiple_of(4);
        let mut padded = Vec::with_capacity(length);
        padded.extend_from_slice(body);
        padded.resize(length, 0);
        let sample = Sample { body: padded, info };
        if writer.qos.transient_local {
            writer.latched.push_back(sample.clone());
            while writer.latched.len() > writer.qos.depth as usize {
                writer.latched.pop_front();
            }
        }
        let faults = self.faults.get(&writer.topic).copied().unwrap_or_default();
        for reader in self.readers.iter_mut().filter(|r| r.alive && r.topic == writer.topic) {
            let reliable = reader.demand.reliable && writer.qos.reliable;
            for delay in self.dice.arrivals(&faults, reliable) {
                reader.deliver(now + delay, sample.clone(), reliable, &self.time);
            }
        }
        info.sequence
    }
}

impl Reader {
    /// Inserts a sample by its due time; a reliable one not before an earlier one of the same writer.
    fn deliver(&mut self, due: Duration, mut sample: Sample, reliable: bool, time: &Time) {
        let writer = sample.info.writer;
        let behind = self.queue.iter().filter(|(_, s)| s.info.writer == writer).map(|(due, _)| *due).max();
        let due = if reliable { behind.map_or(due, |b| b.max(due)) } else { due };
        if let Some(received) = time.wall_at(due) {
            sample.info.received = received;
        }
        let place = self.queue.partition_point(|(other, _)| *other <= due);
        self.queue.insert(place, (due, sample));
        while self.queue.len() > self.demand.depth as usize {
            self.queue.pop_front();
        }
    }

    pub(super) fn has_data(&self, now: Duration) -> bool {
        self.queue.front().is_some_and(|(due, _)| *due <= now)
    }

    pub(super) fn next_due(&self) -> Option<Duration> {
        self.queue.front().map(|(due, _)| *due)
    }

    pub(super) fn take(&mut self, now: Duration) -> Option<Sample> {
        if !self.has_data(now) {
            return None;
        }
        self.queue.pop_front().map(|(_, sample)| sample)
    }
}
