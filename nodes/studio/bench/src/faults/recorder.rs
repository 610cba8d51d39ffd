//! The recording of a run in memory, by the rules of the recorder.

use grainlab_core::Packing;
use grainlab_msgs::{Guid, Topic, from_cdr, msg, topics};
use grainlab_node_kit::{Bus, BusError, Demand, Next, Node, NodeError, SubscriptionId, member_of};
use grainlab_recorder::repeats::{Novelty, Repeats};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;
use std::time::Duration;

/// Topics that are a pure function of scene and seed.
const REPRODUCIBLE: [Topic; 5] =
    [topics::STRESS, topics::STRAIN_RATE, topics::PACKING, topics::PACKING_REPORT, topics::MICROSTRUCTURE];

/// The record of a run.
#[derive(Debug, Default)]
pub(super) struct Record {
    /// Whole bodies by topic, each once.
    bodies: BTreeMap<&'static str, Vec<Vec<u8>>>,
    /// The last run state.
    pub(super) state: Option<msg::RunState>,
    /// Samples received, including repeats.
    pub(super) seen: u64,
    /// Messages that contradict a recorded one.
    pub(super) contradictions: u64,
}

impl Record {
    /// The last packing, and the run state in it.
    pub(super) fn last_packing(&self) -> Option<(Packing, Vec<u8>)> {
        let message: msg::Packing = from_cdr(self.bodies.get(topics::PACKING.name)?.last()?).ok()?;
        Some((Packing::try_from(&message).ok()?, message.run_state))
    }

    pub(super) fn packings(&self) -> usize {
        self.bodies.get(topics::PACKING.name).map_or(0, Vec::len)
    }

    /// True if the path is done and the last packing is inverted.
    pub(super) fn is_complete(&self) -> bool {
        let finished = |s: &&msg::RunState| s.state == msg::RunState::FINISHED;
        let Some(state) = self.state.as_ref().filter(finished) else { return false };
        let Some(step) = state.last_packing() else { return true };
        let found = self.bodies.get(topics::MICROSTRUCTURE.name).into_iter().flatten();
        found.filter_map(|body| from_cdr::<msg::Microstructure>(body).ok()).any(|m| m.source_step == step)
    }

    /// The first result that a finished run lacks: the structure of a packing, or the microstructure from its
    /// stiffness. The launcher ends such a run with exit 3.
    pub(super) fn lacks(&self) -> Option<String> {
        let steps = |topic: &Topic, step: &dyn Fn(&[u8]) -> Option<u64>| -> BTreeSet<u64> {
            self.bodies.get(topic.name).into_iter().flatten().filter_map(|body| step(body)).collect()
        };
        let packings = steps(&topics::PACKING, &|b| from_cdr::<msg::Packing>(b).ok().map(|m| m.step));
        let report = |b: &[u8]| from_cdr::<msg::PackingReport>(b).ok();
        let measured = steps(&topics::PACKING_REPORT, &|b| Some(report(b)?.source_step));
        let jammed = steps(&topics::PACKING_REPORT, &|b| {
            report(b).filter(|m| !m.stiffness.is_empty()).map(|m| m.source_step)
        });
        let found = steps(&topics::MICROSTRUCTURE, &|b| {
            from_cdr::<msg::Microstructure>(b).ok().map(|m| m.source_step)
        });
        let packing = packings
            .difference(&measured)
            .next()
            .map(|s| format!("the packing of step {s} was not analysed"));
        packing.or_else(|| {
            jammed.difference(&found).next().map(|s| format!("the moduli of step {s} were not inverted"))
        })
    }

    /// The first topic on which two records differ. Requests and answers have an order; results may arrive in
    /// any order.
    pub(super) fn difference(&self, other: &Record) -> Option<&'static str> {
        let sorted = |record: &Record, name: &str| {
            let mut bodies = record.bodies.get(name).cloned().unwrap_or_default();
            bodies.sort();
            bodies
        };
        REPRODUCIBLE.iter().map(|t| t.name).find(|name| sorted(self, name) != sorted(other, name))
    }
}

/// Records every reproducible topic.
pub(super) struct MemoryRecorder {
    subscriptions: Vec<(Topic, SubscriptionId)>,
    states: SubscriptionId,
    repeats: Repeats,
    record: Rc<RefCell<Record>>,
}

impl MemoryRecorder {
    pub(super) fn new(bus: &mut dyn Bus, record: &Rc<RefCell<Record>>) -> Result<Self, BusError> {
        let demand = Demand::reliable(100_000);
        let subscribe = |topic: &Topic| Ok((*topic, bus.subscribe(topic, demand)?));
        let subscriptions = REPRODUCIBLE.iter().map(subscribe).collect::<Result<_, BusError>>()?;
        let states = bus.subscribe(&topics::RUN_STATE, demand)?;
        Ok(Self { subscriptions, states, repeats: Repeats::default(), record: Rc::clone(record) })
    }
}

impl Node for MemoryRecorder {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        let mut record = self.record.borrow_mut();
        for (topic, subscription) in &self.subscriptions {
            while let Some(sample) = bus.take(*subscription)? {
                record.seen += 1;
                // A process that was started again counts as the one before it.
                let author = Guid([member_of(&sample.info.writer.participant()); 16]);
                match self.repeats.enter(topic, author, &sample.body, |_| true) {
                    Novelty::New => record.bodies.entry(topic.name).or_default().push(sample.body),
                    Novelty::Repeat => {}
                    Novelty::Contradiction { .. } => record.contradictions += 1,
                }
            }
        }
        while let Some(sample) = bus.take(self.states)? {
            let state = from_cdr::<msg::RunState>(&sample.body).ok();
            record.state = state.filter(|s| s.checked().is_ok()).or(record.state.take());
        }
        Ok(Next::Wait(Duration::from_secs(3600)))
    }
}
