//! The receiver: assembles the parts of several writers into bodies, and reports missing parts in credits.

use super::assembly::Assembly;
use super::limits::{CREDIT_PERIOD, IDLE_CREDIT_PERIOD};
use super::part::{PartError, Shape};
use grainlab_msgs::Guid;
use grainlab_msgs::msg::{PackingChunk, PackingCredit};
use std::collections::BTreeMap;
use std::time::Duration;

/// Maximum number of writers; beyond it, the one silent for longest is removed.
const WRITERS: usize = 8;

/// A writer that is not in the graph and has sent nothing for this long is removed.
const FORGET: Duration = Duration::from_secs(10);

/// A body is given up after it was complete and corrupt this many times.
const ATTEMPTS: u32 = 3;

/// Minimum time between two credits in response to parts received before.
const NOT_AGAIN: Duration = Duration::from_millis(10);

#[derive(Debug, Default)]
pub(super) struct PartOutcome {
    /// The body, if this part completes it, after its sequence number among those that the writer sent in parts.
    pub(super) whole: Option<(i64, Vec<u8>)>,
    pub(super) fault: Option<PartError>,
    pub(super) begins: bool,
}

#[derive(Debug)]
struct Repetition {
    sent: Duration,
    due: Duration,
    pause: Duration,
}

impl Repetition {
    /// Due at once, then at growing intervals.
    fn new(now: Duration) -> Self {
        Self { sent: Duration::ZERO, due: now, pause: CREDIT_PERIOD }
    }

    fn mark_sent(&mut self, now: Duration, missing: bool) {
        self.sent = now;
        self.due = now + self.pause;
        self.pause = if missing { CREDIT_PERIOD } else { (2 * self.pause).min(IDLE_CREDIT_PERIOD) };
    }
}

#[derive(Debug)]
struct Source {
    latest_part: Duration,
    /// The latest complete or abandoned body, and its number of parts.
    done: (u64, u32),
    assembly: Option<Assembly>,
    attempts: u32,
    credit: Repetition,
}

/// All writers of one topic of parts. It has no clock and no bus: the caller provides both.
#[derive(Debug)]
pub(super) struct Receiver {
    sources: BTreeMap<Guid, Source>,
    ready: bool,
    /// The credit to all writers while none has sent a part.
    broadcast: Repetition,
}

impl Receiver {
    pub(super) fn new(now: Duration) -> Self {
        Self { sources: BTreeMap::new(), ready: true, broadcast: Repetition::new(now) }
    }

    /// Sets whether new bodies are accepted. A body in transit is completed in any case.
    pub(super) fn set_ready(&mut self, now: Duration, ready: bool) {
        if self.ready != ready {
            self.ready = ready;
            self.send_credits_now(now);
        }
    }

    pub(super) fn send_credits_now(&mut self, now: Duration) {
        self.sources.values_mut().for_each(|source| source.credit = Repetition::new(now));
        self.broadcast = Repetition::new(now);
    }

    pub(super) fn receive(&mut self, now: Duration, from: Guid, part: &PackingChunk) -> PartOutcome {
        let shape = match Shape::checked(part) {
            Ok(shape) => shape,
            Err(fault) => return PartOutcome { fault: Some(fault), ..PartOutcome::default() },
        };
        self.make_room_for(from);
        let new = Source {
            latest_part: now,
            done: (0, 0),
            assembly: None,
            attempts: 0,
            credit: Repetition::new(now),
        };
        let source = self.sources.entry(from).or_insert(new);
        source.latest_part = now;
        source.receive(now, part, shape)
    }

    /// The credits that are due, marked as sent.
    pub(super) fn credits(&mut self, now: Duration) -> Vec<PackingCredit> {
        if self.sources.is_empty() {
            if self.broadcast.due > now {
                return Vec::new();
            }
            self.broadcast.mark_sent(now, false);
            return vec![PackingCredit { ready: self.ready, ..PackingCredit::default() }];
        }
        let due = self.sources.iter_mut().filter(|(_, source)| source.credit.due <= now);
        let credit = |(id, source): (&Guid, &mut Source)| {
            source.credit.mark_sent(now, source.assembly.is_some());
            let (body, (next, held)) = match &source.assembly {
                Some(assembly) => (assembly.shape.body, assembly.credit()),
                None => (source.done.0, (source.done.1, 0)),
            };
            PackingCredit { writer: id.0, body, next, held, ready: self.ready }
        };
        due.map(credit).collect()
    }

    pub(super) fn due(&self) -> Duration {
        self.sources.values().map(|source| source.credit.due).min().unwrap_or(self.broadcast.due)
    }

    #[cfg(test)]
    pub(super) fn keeps_parts(&self) -> bool {
        self.sources.values().any(|source| source.assembly.is_some())
    }

    pub(super) fn forget_absent(&mut self, now: Duration, present: &[Guid]) {
        let stays = |id: &Guid, source: &Source| {
            present.contains(id) || now.saturating_sub(source.latest_part) < FORGET
        };
        self.sources.retain(|id, source| stays(id, source));
    }

    fn make_room_for(&mut self, new: Guid) {
        if self.sources.len() < WRITERS || self.sources.contains_key(&new) {
            return;
        }
        let quietest = self.sources.iter().min_by_key(|(_, source)| source.latest_part).map(|(id, _)| *id);
        if let Some(id) = quietest {
            self.sources.remove(&id);
        }
    }
}

impl Source {
    fn receive(&mut self, now: Duration, part: &PackingChunk, shape: Shape) -> PartOutcome {
        let mut outcome = PartOutcome::default();
        let current = self.assembly.as_ref().map_or(self.done.0, |a| a.shape.body);
        if part.body < current || part.body == self.done.0 {
            // The writer has not received the credit for it.
            if now.saturating_sub(self.credit.sent) >= NOT_AGAIN {
                self.credit = Repetition::new(now);
            }
            return outcome;
        }
        if part.body > current {
            let before = self.assembly.take();
            outcome.fault = before.map(|old| {
                let (held, Shape { body, count, .. }) = (old.parts(), old.shape);
                PartError(format!("the writer gave up body {body} after {held} of {count} parts"))
            });
            self.attempts = 0;
        }
        let assembly = self.assembly.get_or_insert_with(|| {
            outcome.begins = true;
            Assembly::new(shape)
        });
        match assembly.add(part, &shape) {
            Ok(true) => self.credit = Repetition::new(now),
            Ok(false) => {}
            Err(fault) => outcome.fault = Some(fault),
        }
        if let Some(complete) = self.assembly.take_if(|a| a.is_complete()) {
            self.finish(complete, &mut outcome);
        }
        outcome
    }

    fn finish(&mut self, assembly: Assembly, outcome: &mut PartOutcome) {
        let shape = assembly.shape;
        match assembly.into_body() {
            Ok(body) => {
                self.done = (shape.body, shape.count);
                outcome.whole = Some((i64::try_from(shape.body).unwrap_or(i64::MAX), body));
            }
            Err(found) => {
                self.attempts += 1;
                let again = self.attempts < ATTEMPTS;
                let action = if again { "requested again" } else { "given up" };
                outcome.fault = Some(PartError(format!(
                    "body {} is corrupt: its CRC is {found:08x}, and its parts state {:08x}; {action}",
                    shape.body, shape.body_crc
                )));
                if again {
                    self.assembly = Some(Assembly::new(shape));
                } else {
                    self.done = (shape.body, shape.count);
                }
            }
        }
    }
}
