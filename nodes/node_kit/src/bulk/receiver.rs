//! The reading end: parts of any number of writers become bodies, and credits say what is missing.

use super::assembly::Assembly;
use super::limits::{REPEAT, REST};
use super::part::{PartError, Shape};
use crate::sample::WriterId;
use grainlab_msgs::msg::{PackingChunk, PackingCredit};
use std::collections::BTreeMap;
use std::time::Duration;

/// Writers that are listened to at once; of more, the ones silent for longest are forgotten.
const WRITERS: usize = 8;

/// A writer that is not in the graph and sends nothing for this long is forgotten.
const FORGET: Duration = Duration::from_secs(10);

/// A body that comes whole and corrupt so often is given up.
const ATTEMPTS: u32 = 3;

/// Least time between two credits for parts that are here already.
const NOT_AGAIN: Duration = Duration::from_millis(10);

/// A body, as its writer had it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Whole {
    /// Its place among the bodies that the writer sent in parts.
    pub(super) number: i64,
    pub(super) body: Vec<u8>,
}

/// What a part led to.
#[derive(Debug, Default)]
pub(super) struct Heard {
    /// It was the last one missing.
    pub(super) whole: Option<Whole>,
    /// It, or what it belongs to, was refused.
    pub(super) fault: Option<PartError>,
    /// It is the first of its body.
    pub(super) begins: bool,
}

/// When a credit is said again.
#[derive(Debug)]
struct Repetition {
    said: Duration,
    due: Duration,
    pause: Duration,
}

impl Repetition {
    /// At once, then ever more rarely.
    fn new(now: Duration) -> Self {
        Self { said: Duration::ZERO, due: now, pause: REPEAT }
    }

    fn said(&mut self, now: Duration, missing: bool) {
        self.said = now;
        self.due = now + self.pause;
        self.pause = if missing { REPEAT } else { (2 * self.pause).min(REST) };
    }
}

/// One writer.
#[derive(Debug)]
struct Source {
    heard: Duration,
    /// The latest body that is done with, and its count of parts.
    done: (u64, u32),
    assembly: Option<Assembly>,
    attempts: u32,
    credit: Repetition,
}

/// All writers of one topic of parts. It has no clock and no bus: the caller brings both.
#[derive(Debug)]
pub(super) struct Receiver {
    sources: BTreeMap<WriterId, Source>,
    ready: bool,
    /// What is said to everybody while no writer was heard.
    greeting: Repetition,
}

impl Receiver {
    pub(super) fn new(now: Duration) -> Self {
        Self { sources: BTreeMap::new(), ready: true, greeting: Repetition::new(now) }
    }

    /// Whether more is taken. What is under way is finished in any case.
    pub(super) fn set_ready(&mut self, now: Duration, ready: bool) {
        if self.ready != ready {
            self.ready = ready;
            self.greet(now);
        }
    }

    /// Says at once to everybody how things stand.
    pub(super) fn greet(&mut self, now: Duration) {
        self.sources.values_mut().for_each(|source| source.credit = Repetition::new(now));
        self.greeting = Repetition::new(now);
    }

    /// Takes in one part.
    pub(super) fn hear(&mut self, now: Duration, from: WriterId, part: &PackingChunk) -> Heard {
        let shape = match Shape::checked(part) {
            Ok(shape) => shape,
            Err(fault) => return Heard { fault: Some(fault), ..Heard::default() },
        };
        self.make_room_for(from);
        let new =
            Source { heard: now, done: (0, 0), assembly: None, attempts: 0, credit: Repetition::new(now) };
        let source = self.sources.entry(from).or_insert(new);
        source.heard = now;
        source.hear(now, part, shape)
    }

    /// The credits to say now.
    pub(super) fn credits(&mut self, now: Duration) -> Vec<PackingCredit> {
        if self.sources.is_empty() {
            if self.greeting.due > now {
                return Vec::new();
            }
            self.greeting.said(now, false);
            return vec![PackingCredit { ready: self.ready, ..PackingCredit::default() }];
        }
        let due = self.sources.iter_mut().filter(|(_, source)| source.credit.due <= now);
        let say = |(id, source): (&WriterId, &mut Source)| {
            source.credit.said(now, source.assembly.is_some());
            let (body, (next, held)) = match &source.assembly {
                Some(assembly) => (assembly.shape.body, assembly.credit()),
                None => (source.done.0, (source.done.1, 0)),
            };
            PackingCredit { writer: id.0, body, next, held, ready: self.ready }
        };
        due.map(say).collect()
    }

    /// When the next credit is due.
    pub(super) fn due(&self) -> Duration {
        self.sources.values().map(|source| source.credit.due).min().unwrap_or(self.greeting.due)
    }

    /// Parts here and in all of the body that is under way, if one is.
    pub(super) fn under_way(&self) -> Option<(u64, u32)> {
        let assemblies = self.sources.values().filter_map(|source| source.assembly.as_ref());
        assemblies.map(|assembly| (assembly.parts(), assembly.shape.count)).next()
    }

    /// Forgets writers that went.
    pub(super) fn tend(&mut self, now: Duration, present: &[WriterId]) {
        let stays = |id: &WriterId, source: &Source| {
            present.contains(id) || now.saturating_sub(source.heard) < FORGET
        };
        self.sources.retain(|id, source| stays(id, source));
    }

    fn make_room_for(&mut self, new: WriterId) {
        if self.sources.len() < WRITERS || self.sources.contains_key(&new) {
            return;
        }
        let quietest = self.sources.iter().min_by_key(|(_, source)| source.heard).map(|(id, _)| *id);
        if let Some(id) = quietest {
            self.sources.remove(&id);
        }
    }
}

impl Source {
    fn hear(&mut self, now: Duration, part: &PackingChunk, shape: Shape) -> Heard {
        let mut heard = Heard::default();
        let current = self.assembly.as_ref().map_or(self.done.0, |a| a.shape.body);
        if part.body < current || part.body == self.done.0 {
            // The writer has not heard that we have it.
            if now.saturating_sub(self.credit.said) >= NOT_AGAIN {
                self.credit = Repetition::new(now);
            }
            return heard;
        }
        if part.body > current {
            let before = self.assembly.take();
            heard.fault = before.map(|old| PartError::GivenUp {
                body: old.shape.body,
                held: old.parts(),
                count: old.shape.count,
            });
            self.attempts = 0;
        }
        let assembly = self.assembly.get_or_insert_with(|| {
            heard.begins = true;
            Assembly::new(shape)
        });
        match assembly.add(part, &shape) {
            Ok(true) => self.credit = Repetition::new(now),
            Ok(false) => {}
            Err(fault) => heard.fault = Some(fault),
        }
        if let Some(complete) = self.assembly.take_if(|a| a.is_complete()) {
            self.finish(complete, &mut heard);
        }
        heard
    }

    fn finish(&mut self, assembly: Assembly, heard: &mut Heard) {
        let shape = assembly.shape;
        match assembly.into_body() {
            Ok(body) => {
                self.done = (shape.body, shape.count);
                heard.whole = Some(Whole { number: i64::try_from(shape.body).unwrap_or(i64::MAX), body });
            }
            Err(found) => {
                self.attempts += 1;
                let again = self.attempts < ATTEMPTS;
                let what = if again { "it is asked for again" } else { "it is given up" };
                heard.fault = Some(PartError::Body { body: shape.body, found, said: shape.body_crc, what });
                if again {
                    self.assembly = Some(Assembly::new(shape));
                } else {
                    self.done = (shape.body, shape.count);
                }
            }
        }
    }
}
