//! The record of a run in memory.

use grainlab_core::Packing;
use grainlab_msgs::{Guid, Message, Topic, from_cdr, msg, topics};
use grainlab_node_kit::{Bus, BusError, Demand, Next, Node, NodeError, SubscriptionId, member_of};
use grainlab_recorder::repeats::{Novelty, Repeats};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;
use std::time::Duration;

/// Topics that are a pure function of scene and seed.
pub(crate) const REPRODUCIBLE: [Topic; 5] =
    [topics::STRESS, topics::STRAIN_RATE, topics::PACKING, topics::PACKING_REPORT, topics::MICROSTRUCTURE];

/// Whole bodies by topic, in the order of arrival.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    bodies: BTreeMap<&'static str, Vec<Vec<u8>>>,
    /// Samples received on the reproducible topics, including repeats.
    pub(crate) seen: u64,
    /// Messages that contradict a recorded one.
    pub(crate) contradictions: u64,
}

impl Record {
    /// Returns the bodies of a topic.
    pub fn bodies(&self, topic: &Topic) -> &[Vec<u8>] {
        self.bodies.get(topic.name).map_or(&[], Vec::as_slice)
    }

    /// Returns the messages of a topic.
    ///
    /// # Panics
    /// If one is no message of type `T`.
    pub fn messages<T: Message>(&self, topic: &Topic) -> Vec<T> {
        self.bodies(topic).iter().map(|body| from_cdr(body).expect("a message of the topic's type")).collect()
    }

    /// Returns the last message of a topic.
    ///
    /// # Panics
    /// If it is no message of type `T`.
    pub fn last<T: Message>(&self, topic: &Topic) -> Option<T> {
        self.bodies(topic).last().map(|body| from_cdr(body).expect("a message of the topic's type"))
    }

    /// Returns every body of a topic once, at its first arrival.
    fn once(&self, topic: &Topic) -> Vec<Vec<u8>> {
        let mut seen = BTreeSet::new();
        self.bodies(topic).iter().filter(|body| seen.insert(*body)).cloned().collect()
    }

    /// Returns the reproducible topics, every body once, at its first arrival.
    pub fn without_repeats(&self) -> Self {
        let bodies = REPRODUCIBLE.iter().map(|t| (t.name, self.once(t))).collect();
        Self { bodies, ..Self::default() }
    }

    /// Returns the reproducible topics, every body once, sorted: under faults, results arrive in any order.
    pub fn sorted(&self) -> Self {
        let mut record = self.without_repeats();
        record.bodies.values_mut().for_each(|bodies| bodies.sort());
        record
    }

    /// Returns the first reproducible topic on which two records differ.
    pub fn difference(&self, other: &Self) -> Option<&'static str> {
        REPRODUCIBLE.iter().map(|t| t.name).find(|name| self.bodies.get(name) != other.bodies.get(name))
    }

    /// Returns the last valid run state.
    pub(crate) fn state(&self) -> Option<msg::RunState> {
        let states = self.bodies(&topics::RUN_STATE).iter().rev();
        states.filter_map(|body| from_cdr::<msg::RunState>(body).ok()).find(|s| s.checked().is_ok())
    }

    /// Returns true if the path is done and the last packing is inverted.
    pub fn complete(&self) -> bool {
        let Some(state) = self.state().filter(|s| s.state == msg::RunState::FINISHED) else { return false };
        let Some(step) = state.last_packing() else { return true };
        let found = self.bodies(&topics::MICROSTRUCTURE).iter();
        found.filter_map(|body| from_cdr::<msg::Microstructure>(body).ok()).any(|m| m.source_step == step)
    }

    /// Returns the last packing, and the run state in it.
    pub(crate) fn last_packing(&self) -> Option<(Packing, Vec<u8>)> {
        let message: msg::Packing = from_cdr(self.once(&topics::PACKING).last()?).ok()?;
        Some((Packing::try_from(&message).ok()?, message.run_state))
    }

    /// Returns the number of different packings.
    pub(crate) fn packings(&self) -> usize {
        self.once(&topics::PACKING).len()
    }

    /// Returns the first result that a finished run lacks: the structure of a packing, or the microstructure from its
    /// stiffness. The launcher ends such a run with exit 3.
    pub(crate) fn lacks(&self) -> Option<String> {
        let steps = |topic: &Topic, step: &dyn Fn(&[u8]) -> Option<u64>| -> BTreeSet<u64> {
            self.bodies(topic).iter().filter_map(|body| step(body)).collect()
        };
        let packings = steps(&topics::PACKING, &|b| from_cdr::<msg::Packing>(b).ok().map(|m| m.step));
        let measured = steps(&topics::PACKING_REPORT, &|b| {
            from_cdr::<msg::PackingReport>(b).ok().map(|m| m.source_step)
        });
        let found = steps(&topics::MICROSTRUCTURE, &|b| {
            from_cdr::<msg::Microstructure>(b).ok().map(|m| m.source_step)
        });
        let packing = packings
            .difference(&measured)
            .next()
            .map(|s| format!("the packing of step {s} was not analysed"));
        packing.or_else(|| {
            measured.difference(&found).next().map(|s| format!("the report of step {s} was not inverted"))
        })
    }
}

/// Records topics, and compares repetitions by the rules of the recorder.
pub(crate) struct MemoryRecorder {
    subscriptions: Vec<(Topic, SubscriptionId)>,
    repeats: Repeats,
    record: Rc<RefCell<Record>>,
}

impl MemoryRecorder {
    pub(crate) fn new(
        bus: &mut dyn Bus,
        topics: &[Topic],
        record: &Rc<RefCell<Record>>,
    ) -> Result<Self, BusError> {
        let subscribe = |topic: &Topic| Ok((*topic, bus.subscribe(topic, Demand::reliable(100_000))?));
        let subscriptions = topics.iter().map(subscribe).collect::<Result<_, BusError>>()?;
        Ok(Self { subscriptions, repeats: Repeats::default(), record: Rc::clone(record) })
    }
}

impl Node for MemoryRecorder {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        let mut record = self.record.borrow_mut();
        for (topic, subscription) in &self.subscriptions {
            let reproducible = REPRODUCIBLE.iter().any(|t| t.name == topic.name);
            while let Some(sample) = bus.take(*subscription)? {
                if reproducible {
                    record.seen += 1;
                    // A process that was started again counts as the one before it.
                    let author = Guid([member_of(&sample.info.writer.participant()); 16]);
                    let novelty = self.repeats.enter(topic, author, &sample.body, |_| true);
                    record.contradictions += u64::from(matches!(novelty, Novelty::Contradiction { .. }));
                }
                record.bodies.entry(topic.name).or_default().push(sample.body);
            }
        }
        Ok(Next::Wait(Duration::from_secs(3600)))
    }
}
