//! The laboratory in one thread: all nodes and a recorder on the bus in memory.

use grainlab_dem_simulator::{DemSimulator, Settings};
use grainlab_emt_inversion::EmtInversion;
use grainlab_fabric_analyzer::FabricAnalyzer;
use grainlab_msgs::msg::{Microstructure, RunState};
use grainlab_msgs::{Message, Topic, from_cdr, topics};
use grainlab_node_kit::{
    Actor, Bus, Demand, Exit, Faults, Hub, MemoryBus, Names, Next, Node, NodeError, SubscriptionId, run_until,
};
use grainlab_scene::Scene;
use grainlab_servo_controller::ServoController;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::time::Duration;

/// The reproducible topics.
pub(crate) const REPRODUCIBLE: [Topic; 5] =
    [topics::STRESS, topics::STRAIN_RATE, topics::PACKING, topics::PACKING_REPORT, topics::MICROSTRUCTURE];

/// Virtual time that exceeds every run.
pub(crate) const FOREVER: Duration = Duration::from_secs(10_000);

pub(crate) fn scene() -> Scene {
    Scene::parse(include_str!("tiny.toml")).expect("a valid scene")
}

/// Whole bodies by topic, in the order of arrival.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Record(pub(crate) BTreeMap<&'static str, Vec<Vec<u8>>>);

impl Record {
    pub(crate) fn bodies(&self, topic: &Topic) -> &[Vec<u8>] {
        self.0.get(topic.name).map_or(&[], Vec::as_slice)
    }

    pub(crate) fn messages<T: Message>(&self, topic: &Topic) -> Vec<T> {
        self.bodies(topic).iter().map(|body| from_cdr(body).expect("a message of the topic's type")).collect()
    }

    pub(crate) fn last<T: Message>(&self, topic: &Topic) -> Option<T> {
        self.bodies(topic).last().map(|body| from_cdr(body).expect("a message of the topic's type"))
    }

    /// The reproducible topics, every body once, at its first arrival.
    pub(crate) fn without_repeats(&self) -> Record {
        let once = |bodies: &[Vec<u8>]| {
            let mut seen = std::collections::BTreeSet::new();
            bodies.iter().filter(|body| seen.insert(*body)).cloned().collect::<Vec<_>>()
        };
        Record(REPRODUCIBLE.iter().map(|t| (t.name, once(self.bodies(t)))).collect())
    }

    /// The first topic on which two records differ.
    pub(crate) fn difference(&self, other: &Record) -> Option<&'static str> {
        REPRODUCIBLE.iter().map(|t| t.name).find(|name| self.0.get(name) != other.0.get(name))
    }

    /// True if a microstructure of the last packing of a finished run exists.
    pub(crate) fn complete(&self) -> bool {
        let Some(end) = self.last::<RunState>(&topics::RUN_STATE) else { return false };
        let last = self.last::<Microstructure>(&topics::MICROSTRUCTURE).map(|m| m.source_step);
        end.state == RunState::FINISHED && last == Some(end.last_packing_step)
    }
}

/// Records all topics.
pub(crate) struct Recorder {
    subscriptions: Vec<(&'static str, SubscriptionId)>,
    record: Rc<RefCell<Record>>,
}

impl Recorder {
    pub(crate) fn new(bus: &mut dyn Bus, record: &Rc<RefCell<Record>>) -> Self {
        let all = REPRODUCIBLE.into_iter().chain([topics::RUN_STATE, topics::STRESS_SAMPLED]);
        let subscriptions =
            all.map(|t| (t.name, bus.subscribe(&t, Demand::reliable(100_000)).expect("a topic"))).collect();
        Self { subscriptions, record: Rc::clone(record) }
    }
}

impl Node for Recorder {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        for (name, subscription) in &self.subscriptions {
            while let Some(sample) = bus.take(*subscription)? {
                self.record.borrow_mut().0.entry(name).or_default().push(sample.body);
            }
        }
        Ok(Next::Wait(Duration::from_secs(3600)))
    }
}

/// A network with the names of the four nodes, and a recorder.
pub(crate) struct Bench {
    pub(crate) hub: Hub,
    pub(crate) record: Rc<RefCell<Record>>,
}

impl Bench {
    pub(crate) fn new(seed: u64) -> Self {
        Self { hub: Hub::new(seed), record: Rc::default() }
    }

    /// A bench whose network loses, repeats and delays messages.
    pub(crate) fn faulty(seed: u64) -> Self {
        let bench = Self::new(seed);
        let faults = Faults { drop: 0.1, duplicate: 0.2, delay: Duration::from_millis(30) };
        for topic in REPRODUCIBLE {
            bench.hub.set_faults(&topic.absolute_name(), faults);
        }
        bench
    }

    pub(crate) fn bus(&self, node: &str) -> MemoryBus {
        self.hub.bus(Names::new(node).expect("a name"))
    }

    pub(crate) fn simulator(
        &self,
        settings: &Settings,
        resume: Option<(grainlab_core::Packing, Vec<u8>)>,
    ) -> (DemSimulator, MemoryBus) {
        let mut bus = self.bus("dem_simulator");
        (DemSimulator::new(&mut bus, scene(), resume, settings.clone()).expect("a simulator"), bus)
    }

    pub(crate) fn servo(&self) -> (ServoController, MemoryBus) {
        let mut bus = self.bus("servo_controller");
        (ServoController::new(&mut bus, 1).expect("a servo"), bus)
    }

    pub(crate) fn analyzer(&self) -> (FabricAnalyzer, MemoryBus) {
        let mut bus = self.bus("fabric_analyzer");
        (
            FabricAnalyzer::new(&mut bus, grainlab_fabric_analyzer::Settings::default())
                .expect("an analyzer"),
            bus,
        )
    }

    pub(crate) fn inversion(&self) -> (EmtInversion, MemoryBus) {
        let mut bus = self.bus("emt_inversion");
        (EmtInversion::new(&mut bus, grainlab_emt_inversion::Settings::default()).expect("an inversion"), bus)
    }

    pub(crate) fn recorder(&self) -> (Recorder, MemoryBus) {
        let mut bus = self.bus("recorder");
        (Recorder::new(&mut bus, &self.record), bus)
    }

    /// The whole laboratory from beginning to end.
    pub(crate) fn whole_run(
        self,
        settings: &Settings,
        resume: Option<(grainlab_core::Packing, Vec<u8>)>,
    ) -> Record {
        let (mut recorder, recorder_bus) = self.recorder();
        let (mut analyzer, analyzer_bus) = self.analyzer();
        let (mut inversion, inversion_bus) = self.inversion();
        let (mut servo, servo_bus) = self.servo();
        let (mut simulator, simulator_bus) = self.simulator(settings, resume);
        let mut actors = [
            Actor::new(&mut recorder, recorder_bus),
            Actor::new(&mut analyzer, analyzer_bus),
            Actor::new(&mut inversion, inversion_bus),
            Actor::new(&mut servo, servo_bus),
            Actor::new(&mut simulator, simulator_bus),
        ];
        let complete = run_until(&self.hub, &mut actors, FOREVER, |_| self.record.borrow().complete());
        let ends: Vec<_> = actors.iter().filter_map(|actor| actor.ended.as_ref()).collect();
        assert!(complete, "the run did not end; nodes ended: {ends:?}");
        // Messages in transit belong to the record.
        let end = self.hub.now() + Duration::from_secs(1);
        run_until(&self.hub, &mut actors, end, |_| false);
        self.record.take()
    }
}

/// The end of an actor.
pub(crate) fn exit_of(actor: &Actor) -> Option<Exit> {
    actor.ended.as_ref().map(|end| end.as_ref().map_or_else(|failure| failure.exit, |exit| *exit))
}
