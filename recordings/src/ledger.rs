//! What was recorded, lost and repeated, per topic and per writer.
//!
//! Loss is judged by RTPS sequence numbers, which count every message of one writer from 1: a number that
//! never came is a message that was lost, whoever lost it. What a writer sent after the last number seen,
//! only that writer knows; it reports its count when it ends ([`Ledger::report`]).

use std::collections::{BTreeMap, BTreeSet};

mod guid;
mod merge;
mod sequence;
mod tally;

pub use guid::{Guid, GuidError};
pub use merge::merge;
use sequence::Sequence;
use tally::LISTED_GAPS;
pub use tally::{TopicTally, WriterTally};

#[derive(Clone, Debug, Default)]
struct Writer {
    sequence: Sequence,
    reported: Option<u64>,
    /// Messages that came and say, byte for byte, what another one said that was recorded.
    same: u64,
    /// Messages that came and are left out on purpose: they count neither as published nor as recorded.
    left_out: u64,
}

impl Writer {
    /// Messages before the first one that came; all that it reports, if none came.
    fn before_first(&self) -> u64 {
        self.sequence.first().map_or(self.reported.unwrap_or(0), |first| (first - 1).max(0) as u64)
    }
}

/// The running account of a recording.
#[derive(Clone, Debug, Default)]
pub struct Ledger {
    topics: BTreeMap<String, BTreeMap<Guid, Writer>>,
    nodes: BTreeMap<Guid, String>,
    /// Topics of which each writer counts from its first message that came.
    from_first: BTreeSet<String>,
}

impl Ledger {
    /// Makes `topic` known, so that it is accounted for even if nothing comes.
    pub fn expect(&mut self, topic: &str) {
        if !self.topics.contains_key(topic) {
            self.topics.insert(topic.to_owned(), BTreeMap::new());
        }
    }

    /// Counts each writer of `topic` from the first of its messages that comes: what it said before the recorder was there
    /// is not missed. For topics that tell of processes and not of the run.
    pub fn count_from_first(&mut self, topic: &str) {
        self.from_first.insert(topic.to_owned());
    }

    /// Notes that message `sequence` of this writer came and is not recorded, because it says what a recorded one says; it
    /// counts as repeated.
    pub fn repeat(&mut self, topic: &str, guid: Guid, sequence: i64) {
        if self.enter(topic, guid, sequence)
            && let Some(writer) = self.topics.get_mut(topic).and_then(|writers| writers.get_mut(&guid))
        {
            writer.same += 1;
        }
    }

    /// Notes that message `sequence` of this writer came and is left out on purpose: it is of no interest to the recording.
    pub fn leave_out(&mut self, topic: &str, guid: Guid, sequence: i64) {
        if self.enter(topic, guid, sequence)
            && let Some(writer) = self.topics.get_mut(topic).and_then(|writers| writers.get_mut(&guid))
        {
            writer.left_out += 1;
        }
    }

    /// Whether message `sequence` of this writer was recorded already.
    pub fn holds(&self, topic: &str, guid: &Guid, sequence: i64) -> bool {
        self.topics.get(topic).and_then(|t| t.get(guid)).is_some_and(|w| w.sequence.holds(sequence))
    }

    /// Enters message `sequence` of this writer; `false` if it is a repeat, which is then counted as one.
    pub fn enter(&mut self, topic: &str, guid: Guid, sequence: i64) -> bool {
        self.expect(topic);
        match self.topics.get_mut(topic) {
            Some(writers) => writers.entry(guid).or_default().sequence.enter(sequence),
            None => false,
        }
    }

    /// Notes that a writer says it published `count` messages in all. The largest report counts.
    pub fn report(&mut self, topic: &str, guid: Guid, count: u64) {
        self.expect(topic);
        if let Some(writers) = self.topics.get_mut(topic) {
            let writer = writers.entry(guid).or_default();
            writer.reported = Some(writer.reported.map_or(count, |known| known.max(count)));
        }
    }

    /// Notes which node a writer belongs to.
    pub fn name(&mut self, guid: Guid, node: &str) {
        self.nodes.insert(guid, node.to_owned());
    }

    /// Messages that writers report as published and that have not come: what a recorder that is about to end
    /// may still wait for.
    pub fn outstanding(&self) -> u64 {
        let of_interest = |w: &&Writer| w.left_out == 0 || w.left_out < w.sequence.held();
        let of_topic = |(name, writers): (&String, &BTreeMap<Guid, Writer>)| -> u64 {
            let missed = |w: &Writer| {
                let before = if self.from_first.contains(name) { w.before_first() } else { 0 };
                w.reported.unwrap_or(0).saturating_sub(w.sequence.held() + before)
            };
            writers.values().filter(of_interest).map(missed).sum()
        };
        self.topics.iter().map(of_topic).sum()
    }

    /// The account, topic by topic in order of name.
    pub fn tallies(&self) -> Vec<TopicTally> {
        self.topics.iter().map(|(name, writers)| self.tally(name, writers)).collect()
    }

    fn tally(&self, name: &str, writers: &BTreeMap<Guid, Writer>) -> TopicTally {
        let mut topic = TopicTally {
            name: name.to_owned(),
            published: 0,
            recorded: 0,
            lost: 0,
            repeated: 0,
            writers: Vec::new(),
        };
        for (guid, writer) in writers {
            let s = &writer.sequence;
            // Nothing of it is of interest: what it published before it was heard is not missed.
            if writer.left_out > 0 && writer.left_out == s.held() {
                continue;
            }
            let before = if self.from_first.contains(name) { writer.before_first() } else { 0 };
            let held = s.held();
            let recorded = held - writer.same - writer.left_out;
            // A report that is lower than what was seen is out of date, not proof of a negative loss.
            let published = writer.reported.unwrap_or(0).max(s.highest().max(0) as u64).max(held) - before;
            let lost = published.saturating_sub(held);
            let published = published - writer.left_out;
            topic.published += published;
            topic.recorded += recorded;
            topic.lost += lost;
            topic.repeated += s.repeated() + writer.same;
            topic.writers.push(WriterTally {
                guid: guid.to_string(),
                node: self.nodes.get(guid).cloned(),
                recorded,
                reported: writer.reported,
                first: s.first(),
                last: (held > 0).then(|| s.highest()),
                lost,
                gaps: s
                    .gaps()
                    .filter(|(_, last)| *last >= 0 && *last as u64 > before)
                    .take(LISTED_GAPS)
                    .collect(),
                repeated: s.repeated() + writer.same,
            });
        }
        topic
    }
}

#[cfg(test)]
mod tests;
