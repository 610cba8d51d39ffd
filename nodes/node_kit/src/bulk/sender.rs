//! The writing end: what to send next, and who still lacks what.

use super::limits::{FIRST_WORD, LOST, SILENCE, STALLED, WINDOW};
use super::part::Shape;
use crate::sample::WriterId;
use grainlab_msgs::msg::{PackingChunk, PackingCredit};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// One reader, by the writer of its credits.
#[derive(Clone, Copy, Debug)]
struct Reader {
    /// Of its latest credit, in its writer's sequence.
    sequence: i64,
    heard: Duration,
    /// When it last got anything it lacked.
    progress: Duration,
    /// As in the credit, of the current body.
    next: u32,
    held: u64,
    ready: bool,
    /// It is waited for. Not any more once it was left behind, until it is heard again.
    live: bool,
    /// It was in the graph.
    seen: bool,
}

/// Why a reader is not waited for any more.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct LeftBehind {
    pub(super) reader: WriterId,
    pub(super) reason: String,
}

/// The latest body and everyone who reads it. It has no clock and no bus: the caller brings both.
#[derive(Debug)]
pub(super) struct Sender {
    own: WriterId,
    /// Bodies sent so far; the latest has this number.
    bodies: u64,
    bytes: Vec<u8>,
    /// Of the latest body; `None` if there is none, or it is out of date.
    shape: Option<Shape>,
    offered: Duration,
    /// Parts below this were sent at least once; when each was sent last.
    sent: u32,
    when: Vec<Duration>,
    /// Parts to send again.
    again: BTreeSet<u32>,
    readers: BTreeMap<WriterId, Reader>,
    /// Parts sent more than once.
    repeated: u64,
}

impl Sender {
    pub(super) fn new(own: WriterId) -> Self {
        Self {
            own,
            bodies: 0,
            bytes: Vec::new(),
            shape: None,
            offered: Duration::ZERO,
            sent: 0,
            when: Vec::new(),
            again: BTreeSet::new(),
            readers: BTreeMap::new(),
            repeated: 0,
        }
    }

    /// Parts that were sent more than once.
    pub(super) fn repeated(&self) -> u64 {
        self.repeated
    }

    /// The next body. It takes the place of the one before.
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

    /// The latest message went another way: nobody shall get the body before it instead.
    pub(super) fn retire(&mut self) {
        (self.bytes, self.shape) = (Vec::new(), None);
        self.again.clear();
    }

    /// Takes in one credit. A credit that was overtaken by a later one says nothing.
    pub(super) fn hear(&mut self, now: Duration, from: WriterId, sequence: i64, credit: &PackingCredit) {
        let new = Reader {
            sequence,
            heard: now,
            progress: now,
            next: 0,
            held: 0,
            ready: true,
            live: true,
            seen: false,
        };
        let known = self.readers.get(&from).copied();
        let mut reader = known.unwrap_or(new);
        if known.is_some_and(|known| sequence <= known.sequence) {
            return;
        }
        (reader.sequence, reader.heard, reader.ready) = (sequence, now, credit.ready);
        if !reader.live || !reader.ready {
            (reader.live, reader.progress) = (true, now);
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
                let lost = |part: &u32| now.saturating_sub(self.when[*part as usize]) >= LOST;
                self.again.extend(missing(&reader, self.sent).filter(lost));
            }
        }
        self.readers.insert(from, reader);
    }

    /// The next part to send now, if there is one to send.
    pub(super) fn next_part(&mut self, now: Duration) -> Option<PackingChunk> {
        let shape = self.shape?;
        let index = match self.again.pop_first() {
            Some(index) => {
                self.repeated += 1;
                index
            }
            None if self.sent < self.frontier() => {
                self.sent += 1;
                self.sent - 1
            }
            None => return None,
        };
        self.when[index as usize] = now;
        Some(shape.cut(&self.bytes, index))
    }

    /// The bus did not take a part after all.
    pub(super) fn put_back(&mut self, index: u32) {
        self.again.insert(index);
    }

    /// Parts below this may be sent: a window beyond the slowest reader that lives and is not done.
    fn frontier(&self) -> u32 {
        let Some(shape) = self.shape else { return 0 };
        let waiting = self.readers.values().filter(|r| r.live && r.next < shape.count);
        let ends = waiting.map(|r| if r.ready { r.next.saturating_add(WINDOW) } else { r.next });
        ends.min().map_or(0, |end| end.min(shape.count))
    }

    /// Looks after who is there (`present`: writers of credits in the graph) and who is silent; who is not waited for
    /// any more, and lacks something, is returned.
    pub(super) fn tend(&mut self, now: Duration, present: &[WriterId]) -> Vec<LeftBehind> {
        let count = self.shape.map_or(0, |shape| shape.count);
        let mut left = Vec::new();
        self.readers.retain(|id, reader| {
            let there = present.contains(id);
            let gone = reader.seen && !there;
            reader.seen |= there;
            !gone
        });
        for (id, reader) in self.readers.iter_mut().filter(|(_, r)| r.live) {
            let (silent, stuck) = (now.saturating_sub(reader.heard), now.saturating_sub(reader.progress));
            let reason = if silent > SILENCE {
                format!("it has said nothing for {:.0} s", silent.as_secs_f64())
            } else if reader.ready && reader.next < count && stuck > STALLED {
                format!("it has got nothing for {:.0} s", stuck.as_secs_f64())
            } else {
                continue;
            };
            reader.live = false;
            if reader.next < count {
                let reason = format!("{reason}; it has {} of {count} parts", reader.next);
                left.push(LeftBehind { reader: *id, reason });
            }
        }
        left
    }

    /// Whether a reader that lives, or may, does not have the latest body yet. Some are in the graph before they are heard:
    /// `present`, and the count of readers that are `matched`.
    pub(super) fn is_busy(&self, now: Duration, present: &[WriterId], matched: usize) -> bool {
        let Some(shape) = self.shape else { return false };
        let lacking = self.readers.values().any(|r| r.live && r.next < shape.count);
        let unheard =
            || matched > self.readers.len() || present.iter().any(|id| !self.readers.contains_key(id));
        lacking || (now.saturating_sub(self.offered) < FIRST_WORD && unheard())
    }

    /// Readers that are waited for.
    pub(super) fn waited_for(&self) -> usize {
        let count = self.shape.map_or(0, |shape| shape.count);
        self.readers.values().filter(|r| r.live && r.next < count).count()
    }
}

/// Parts within its window that a reader lacks, of those that were sent.
fn missing(reader: &Reader, sent: u32) -> impl Iterator<Item = u32> {
    let Reader { next, held, .. } = *reader;
    let lacks = move |part: &u32| *part == next || held >> (part - next - 1) & 1 == 0;
    (next..sent.min(next.saturating_add(WINDOW))).filter(lacks)
}
