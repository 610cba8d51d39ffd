//! The sender: the next part to send, and the progress of each reader.

use super::limits::{FIRST_CREDIT_LIMIT, HURRIED, LOST_AFTER, SILENCE, STALLED, WINDOW};
use super::part::Shape;
use grainlab_msgs::Guid;
use grainlab_msgs::msg::{PackingChunk, PackingCredit};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// One reader, identified by the writer of its credits.
#[derive(Clone, Copy, Debug)]
struct Reader {
    /// Sequence number of its latest credit.
    sequence: i64,
    latest_credit: Duration,
    /// Time at which it last received a missing part.
    progress: Duration,
    /// The credit's `next` for the current body.
    next: u32,
    held: u64,
    ready: bool,
    /// True while the sender waits for it: false from a time limit until its next credit.
    active: bool,
    /// True once it was in the graph.
    seen: bool,
}

/// The latest body and its readers. It has no clock and no bus: the caller provides both.
#[derive(Debug, Default)]
pub(super) struct Sender {
    own: Guid,
    /// Number of bodies so far, which is the number of the latest one.
    bodies: u64,
    bytes: Vec<u8>,
    /// Shape of the latest body; `None` if there is none, or it is out of date.
    shape: Option<Shape>,
    offered: Duration,
    /// Parts below this index were sent at least once.
    sent: u32,
    /// Time at which each part was last sent.
    when: Vec<Duration>,
    again: BTreeSet<u32>,
    readers: BTreeMap<Guid, Reader>,
    /// The process is about to end.
    hurries: bool,
}

impl Sender {
    pub(super) fn new(own: Guid) -> Self {
        Self { own, ..Self::default() }
    }

    /// Waits only for a short time for readers that are silent or not ready, and does not hold back parts for them.
    pub(super) fn hurry(&mut self) {
        self.hurries = true;
    }

    pub(super) fn offer(&mut self, now: Duration, bytes: Vec<u8>) {
        self.bodies += 1;
        let shape = Shape::of(self.bodies, &bytes);
        self.when = vec![Duration::ZERO; shape.count as usize];
        (self.bytes, self.shape, self.offered, self.sent) = (bytes, Some(shape), now, 0);
        self.again.clear();
        for reader in self.readers.values_mut() {
            (reader.next, reader.held, reader.progress) = (0, 0, now);
        }
    }

    pub(super) fn is_idle(&self) -> bool {
        self.shape.is_none()
    }

    /// Drops the body: a newer message was sent as one sample.
    pub(super) fn retire(&mut self) {
        (self.bytes, self.shape) = (Vec::new(), None);
        self.again.clear();
    }

    /// Processes one credit. A credit that arrives after a later one is ignored.
    pub(super) fn receive(&mut self, now: Duration, from: Guid, sequence: i64, credit: &PackingCredit) {
        let new = Reader {
            sequence,
            latest_credit: now,
            progress: now,
            next: 0,
            held: 0,
            ready: true,
            active: true,
            seen: false,
        };
        let known = self.readers.get(&from).copied();
        let mut reader = known.unwrap_or(new);
        if known.is_some_and(|known| sequence <= known.sequence) {
            return;
        }
        (reader.sequence, reader.latest_credit, reader.ready) = (sequence, now, credit.ready);
        if !reader.active || !reader.ready {
            (reader.active, reader.progress) = (true, now);
        }
        if let Some(shape) = self.shape {
            if credit.writer == self.own.0 {
                let of_this = credit.body == shape.body;
                let (next, held) = if of_this { (credit.next, credit.held) } else { (0, 0) };
                if (next, held) != (reader.next, reader.held) {
                    reader.progress = now;
                }
                (reader.next, reader.held) = (next.min(shape.count), held);
            }
            if reader.ready {
                let lost = |part: &u32| now.saturating_sub(self.when[*part as usize]) >= LOST_AFTER;
                self.again.extend(missing(&reader, self.sent).filter(lost));
            }
        }
        self.readers.insert(from, reader);
    }

    pub(super) fn next_part(&mut self, now: Duration) -> Option<PackingChunk> {
        let shape = self.shape?;
        let index = match self.again.pop_first() {
            Some(index) => index,
            None if self.sent < self.frontier() => {
                self.sent += 1;
                self.sent - 1
            }
            None => return None,
        };
        self.when[index as usize] = now;
        Some(shape.cut(&self.bytes, index))
    }

    /// Schedules a part that the bus refused.
    pub(super) fn put_back(&mut self, index: u32) {
        self.again.insert(index);
    }

    /// Parts below this index may be sent: a window beyond the slowest active reader with missing parts.
    fn frontier(&self) -> u32 {
        let Some(shape) = self.shape else { return 0 };
        let counts = |r: &&Reader| r.active && r.next < shape.count && (r.ready || !self.hurries);
        let waiting = self.readers.values().filter(counts);
        let ends = waiting.map(|r| if r.ready { r.next.saturating_add(WINDOW) } else { r.next });
        ends.min().map_or(0, |end| end.min(shape.count))
    }

    /// Removes readers that left the graph (`present`: writers of credits in the graph) and applies the time limits.
    ///
    /// Returns the readers with missing parts that are not waited for any longer, and why.
    pub(super) fn apply_time_limits(&mut self, now: Duration, present: &[Guid]) -> Vec<(Guid, String)> {
        let count = self.shape.map_or(0, |shape| shape.count);
        let mut left = Vec::new();
        self.readers.retain(|id, reader| {
            let there = present.contains(id);
            let gone = reader.seen && !there;
            reader.seen |= there;
            !gone
        });
        for (id, reader) in self.readers.iter_mut().filter(|(_, r)| r.active) {
            let (silent, stuck) =
                (now.saturating_sub(reader.latest_credit), now.saturating_sub(reader.progress));
            let (silence, stalled) = if self.hurries { (HURRIED, HURRIED) } else { (SILENCE, STALLED) };
            let reason = if silent > silence {
                format!("no credit for {:.0} s", silent.as_secs_f64())
            } else if (reader.ready || self.hurries) && reader.next < count && stuck > stalled {
                format!("no progress for {:.0} s", stuck.as_secs_f64())
            } else {
                continue;
            };
            reader.active = false;
            if reader.next < count {
                let reason = format!("{reason}; it has {} of {count} parts", reader.next);
                left.push((*id, reason));
            }
        }
        left
    }

    /// True if an active reader lacks parts of the latest body. Readers in the graph that have not sent a credit yet
    /// count for a short time: those of `present`, and the number of `matched` readers.
    pub(super) fn is_busy(&self, now: Duration, present: &[Guid], matched: usize) -> bool {
        let Some(shape) = self.shape else { return false };
        let lacking = self.readers.values().any(|r| r.active && r.next < shape.count);
        let unheard =
            || matched > self.readers.len() || present.iter().any(|id| !self.readers.contains_key(id));
        lacking || (now.saturating_sub(self.offered) < FIRST_CREDIT_LIMIT && unheard())
    }

    /// Last time at which one of them took a part.
    pub(super) fn last_progress(&self) -> Option<Duration> {
        let count = self.shape.map_or(0, |shape| shape.count);
        self.readers.values().filter(|r| r.active && r.next < count).map(|r| r.progress).max()
    }

    /// Number of active readers with missing parts.
    pub(super) fn waited_for(&self) -> usize {
        let count = self.shape.map_or(0, |shape| shape.count);
        self.readers.values().filter(|r| r.active && r.next < count).count()
    }
}

/// The sent parts within its window that a reader lacks.
fn missing(reader: &Reader, sent: u32) -> impl Iterator<Item = u32> {
    let Reader { next, held, .. } = *reader;
    let lacks = move |part: &u32| *part == next || held >> (part - next - 1) & 1 == 0;
    (next..sent.min(next.saturating_add(WINDOW))).filter(lacks)
}
