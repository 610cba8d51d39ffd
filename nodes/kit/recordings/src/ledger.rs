//! Counts of recorded, lost, repeated and conflicting messages, per topic and per writer.
//!
//! Loss is found from RTPS sequence numbers, which count every message of one writer from 1: a missing number
//! is a lost message, wherever it was lost. Messages that a writer sent after the last number received are
//! known from its report at its end ([`Ledger::report`]), and from its announcements ([`Ledger::announce`]).

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
    /// Highest number that the writer announced.
    announced: i64,
    /// Lowest number that the writer offered to this recorder; it may have been replaced before it could be sent.
    offered: Option<i64>,
    /// Lowest and highest number that the writer sent to this recorder in vain.
    failed: Option<(i64, i64)>,
    /// Received messages that equal a recorded one byte for byte.
    same: u64,
    /// Received messages in whose place another one is recorded.
    conflicting: u64,
    /// Received messages that are left out on purpose: they count neither as published nor as recorded.
    left_out: u64,
}

impl Writer {
    /// Lowest number that is due to this recorder, as far as is known.
    fn due(&self) -> Option<i64> {
        let failed = self.failed.map(|(first, _)| first);
        [self.sequence.first.or(self.offered), failed].into_iter().flatten().min()
    }

    /// Number of messages that the writer reported or announced, or could not deliver.
    fn published(&self) -> u64 {
        let announced = self.failed.map_or(self.announced, |(_, last)| self.announced.max(last));
        self.reported.unwrap_or(0).max(announced.max(0) as u64)
    }

    /// Number of messages announced after the last one that arrived or failed.
    fn behind(&self) -> u64 {
        let before = self.offered.filter(|_| self.sequence.held == 0).map_or(0, |offered| offered - 1);
        let settled = self.failed.map_or(before, |(_, last)| before.max(last)).max(self.sequence.highest);
        self.announced.saturating_sub(settled).max(0) as u64
    }

    /// Number of messages before the first one that is due; all reported ones if none is.
    fn before_first(&self) -> u64 {
        self.due().map_or(self.published(), |due| (due - 1).max(0) as u64)
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

    /// Records that a writer announced messages up to number `last`. `offered` is the lowest number that it offered when this
    /// recorder joined; without that number, a writer owes nothing if nothing arrived from it.
    pub fn announce(&mut self, topic: &str, guid: Guid, offered: Option<i64>, last: i64) {
        if last >= 1 && (offered.is_some() || self.has_received(topic, &guid)) {
            let writer = self.topics.entry(topic.to_owned()).or_default().entry(guid).or_default();
            writer.announced = writer.announced.max(last);
            writer.offered = [writer.offered, offered].into_iter().flatten().min();
        }
    }

    /// Records that messages of a writer, from number `first` to `last`, were sent to this recorder and cannot be received.
    pub fn fail(&mut self, topic: &str, guid: Guid, first: i64, last: i64) {
        let writer = self.topics.entry(topic.to_owned()).or_default().entry(guid).or_default();
        let (from, to) = writer.failed.unwrap_or((first, last));
        writer.failed = Some((from.min(first), to.max(last)));
    }

    /// True if any message of this writer was received.
    pub fn has_received(&self, topic: &str, guid: &Guid) -> bool {
        self.topics.get(topic).and_then(|t| t.get(guid)).is_some_and(|w| w.sequence.held > 0)
    }

    /// Records the node of a writer.
    pub fn name(&mut self, guid: Guid, node: &str) {
        self.nodes.insert(guid, node.to_owned());
    }

    /// Number of messages reported or announced as published but not received: an ending recorder
    /// may still wait for them.
    pub fn outstanding(&self) -> u64 {
        let of_interest = |w: &&Writer| w.left_out == 0 || w.left_out < w.sequence.held;
        let of_topic = |(name, writers): (&String, &BTreeMap<Guid, Writer>)| -> u64 {
            let missed = |w: &Writer| {
                let before = if self.from_first.contains(name) { w.before_first() } else { 0 };
                w.reported.unwrap_or(0).saturating_sub(w.sequence.held + before).max(w.behind())
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
            let published = writer.published().max(s.highest.max(0) as u64).max(held).saturating_sub(before);
            tallies.push(WriterTally {
                guid: guid.to_string(),
                node: self.nodes.get(guid).cloned(),
                recorded,
                reported: (writer.reported.is_some() || writer.published() > 0).then(|| writer.published()),
                first: s.first,
                last: (held > 0).then_some(s.highest),
                failed: writer.failed.map(|(first, _)| first),
                lost: published.saturating_sub(held),
                gaps: s
                    .gaps()
                    .filter(|(_, last)| *last >= 0 && *last as u64 > before)
                    .map(|(start, last)| {
                        (start.max(before.saturating_add(1).min(i64::MAX as u64) as i64), last)
                    })
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
