//! Counts of recorded, lost, repeated and conflicting messages, per topic and per writer.
//!
//! Loss is found from RTPS sequence numbers, which count every message of one writer from 1: a missing number
//! is a lost message, wherever it was lost. Messages that a writer sent after the last number received are
//! known from its report at its end ([`Ledger::report`]).

use grainlab_msgs::Guid;
use std::collections::{BTreeMap, BTreeSet};

mod merge;
mod sequence;
mod tally;

pub use merge::merge;
use sequence::Sequence;
use tally::LISTED_GAPS;
pub use tally::{TopicTally, WriterTally};

#[derive(Clone, Debug, Default)]
struct Writer {
    sequence: Sequence,
    reported: Option<u64>,
    /// Received messages that equal a recorded one byte for byte.
    same: u64,
    /// Received messages in whose place another one is recorded.
    conflicting: u64,
    /// Received messages that are left out on purpose: they count neither as published nor as recorded.
    left_out: u64,
}

impl Writer {
    /// Number of messages before the first received one; all reported ones if none was received.
    fn before_first(&self) -> u64 {
        self.sequence.first.map_or(self.reported.unwrap_or(0), |first| (first - 1).max(0) as u64)
    }
}

/// The counts of a recording in progress.
#[derive(Clone, Debug, Default)]
pub struct Ledger {
    topics: BTreeMap<String, BTreeMap<Guid, Writer>>,
    nodes: BTreeMap<Guid, String>,
    /// Topics on which each writer counts from its first received message.
    from_first: BTreeSet<String>,
}

impl Ledger {
    /// Declares `topic`, so that it is listed even without messages.
    pub fn expect(&mut self, topic: &str) {
        if !self.topics.contains_key(topic) {
            self.topics.insert(topic.to_owned(), BTreeMap::new());
        }
    }

    /// Counts each writer of `topic` from its first received message: messages before the recorder joined are
    /// not counted as lost. For topics about processes, as opposed to the run.
    pub fn count_from_first(&mut self, topic: &str) {
        self.from_first.insert(topic.to_owned());
    }

    /// Counts message `sequence` of this writer, which is not recorded because it equals a recorded one; it
    /// counts as repeated.
    pub fn repeat(&mut self, topic: &str, guid: Guid, sequence: i64) {
        self.enter_as(topic, guid, sequence, |writer| writer.same += 1);
    }

    /// Counts message `sequence` of this writer, which is not recorded because another one is in its place: a process
    /// contradicts another, or itself.
    pub fn conflict(&mut self, topic: &str, guid: Guid, sequence: i64) {
        self.enter_as(topic, guid, sequence, |writer| writer.conflicting += 1);
    }

    /// Counts message `sequence` of this writer as received and left out on purpose.
    pub fn leave_out(&mut self, topic: &str, guid: Guid, sequence: i64) {
        self.enter_as(topic, guid, sequence, |writer| writer.left_out += 1);
    }

    fn enter_as(&mut self, topic: &str, guid: Guid, sequence: i64, count: fn(&mut Writer)) {
        if self.enter(topic, guid, sequence)
            && let Some(writer) = self.topics.get_mut(topic).and_then(|writers| writers.get_mut(&guid))
        {
            count(writer);
        }
    }

    /// True if message `sequence` of this writer was recorded already.
    pub fn holds(&self, topic: &str, guid: &Guid, sequence: i64) -> bool {
        self.topics.get(topic).and_then(|t| t.get(guid)).is_some_and(|w| w.sequence.holds(sequence))
    }

    /// Counts message `sequence` of this writer; `false` if it was received before, which is counted as such.
    pub fn enter(&mut self, topic: &str, guid: Guid, sequence: i64) -> bool {
        self.expect(topic);
        match self.topics.get_mut(topic) {
            Some(writers) => writers.entry(guid).or_default().sequence.enter(sequence),
            None => false,
        }
    }

    /// Records that a writer reports `count` published messages in total. The largest report counts.
    pub fn report(&mut self, topic: &str, guid: Guid, count: u64) {
        self.expect(topic);
        if let Some(writers) = self.topics.get_mut(topic) {
            let writer = writers.entry(guid).or_default();
            writer.reported = Some(writer.reported.map_or(count, |known| known.max(count)));
        }
    }

    /// Records the node of a writer.
    pub fn name(&mut self, guid: Guid, node: &str) {
        self.nodes.insert(guid, node.to_owned());
    }

    /// Number of messages reported as published but not received: an ending recorder
    /// may still wait for them.
    pub fn outstanding(&self) -> u64 {
        let of_interest = |w: &&Writer| w.left_out == 0 || w.left_out < w.sequence.held;
        let of_topic = |(name, writers): (&String, &BTreeMap<Guid, Writer>)| -> u64 {
            let missed = |w: &Writer| {
                let before = if self.from_first.contains(name) { w.before_first() } else { 0 };
                w.reported.unwrap_or(0).saturating_sub(w.sequence.held + before)
            };
            writers.values().filter(of_interest).map(missed).sum()
        };
        self.topics.iter().map(of_topic).sum()
    }

    /// The counts of all topics, sorted by name.
    pub fn tallies(&self) -> Vec<TopicTally> {
        self.topics.iter().map(|(name, writers)| self.tally(name, writers)).collect()
    }

    fn tally(&self, name: &str, writers: &BTreeMap<Guid, Writer>) -> TopicTally {
        let mut tallies = Vec::new();
        for (guid, writer) in writers {
            let s = &writer.sequence;
            // No message was received: those published before are not counted as lost.
            if writer.left_out > 0 && writer.left_out == s.held {
                continue;
            }
            let before = if self.from_first.contains(name) { writer.before_first() } else { 0 };
            let held = s.held;
            let recorded = held - writer.same - writer.conflicting - writer.left_out;
            // A report below the highest received number is out of date; it does not mean a negative loss.
            let published = writer.reported.unwrap_or(0).max(s.highest.max(0) as u64).max(held) - before;
            tallies.push(WriterTally {
                guid: guid.to_string(),
                node: self.nodes.get(guid).cloned(),
                recorded,
                reported: writer.reported,
                first: s.first,
                last: (held > 0).then_some(s.highest),
                lost: published.saturating_sub(held),
                gaps: s
                    .gaps()
                    .filter(|(_, last)| *last >= 0 && *last as u64 > before)
                    .take(LISTED_GAPS)
                    .collect(),
                repeated: writer.same,
                conflicting: writer.conflicting,
                left_out: writer.left_out,
                redelivered: s.redelivered,
            });
        }
        merge::topic(name.to_owned(), tallies)
    }
}

#[cfg(test)]
mod tests;
