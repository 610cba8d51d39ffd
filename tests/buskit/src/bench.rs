//! The nodes of a laboratory on the bus in memory, in one thread and in virtual time.

use crate::record::{MemoryRecorder, REPRODUCIBLE, Record};
use grainlab_core::Packing;
use grainlab_dem_simulator::{DemSimulator, Settings};
use grainlab_emt_inversion::EmtInversion;
use grainlab_fabric_analyzer::FabricAnalyzer;
use grainlab_msgs::{Topic, topics};
use grainlab_node_kit::{
    Actor, Exit, Faults, Hub, Identity, MemoryBus, Names, Node, NodeError, RunId, run_until,
};
use grainlab_scene::Scene;
use grainlab_servo_controller::ServoController;
use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

/// Virtual time that exceeds every run.
const FOREVER: Duration = Duration::from_secs(10_000);

/// Returns a scene of 40 grains and three packings.
///
/// # Panics
/// Never: the scene is valid.
pub fn tiny() -> Scene {
    Scene::parse(include_str!("tiny.toml")).expect("a valid scene")
}

/// A kind of node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// It keeps the [`Record`].
    Recorder,
    /// `emt_inversion`.
    Inversion,
    /// `fabric_analyzer`.
    Analyzer,
    /// `servo_controller`.
    Servo,
    /// `dem_simulator`.
    Simulator,
}

impl Kind {
    pub(crate) const ALL: [Kind; 5] =
        [Kind::Recorder, Kind::Inversion, Kind::Analyzer, Kind::Servo, Kind::Simulator];

    fn name(self) -> &'static str {
        ["recorder", "emt_inversion", "fabric_analyzer", "servo_controller", "dem_simulator"][self as usize]
    }
}

/// A network, a scene, and the record of what is published.
pub struct Bench {
    /// The network.
    pub hub: Hub,
    /// The record of every recorder.
    pub record: Rc<RefCell<Record>>,
    scene: Scene,
    /// The run of the nodes; without it they belong to none.
    run: Option<RunId>,
    recorded: Vec<Topic>,
}

impl Bench {
    /// Creates a bench with the scene [`tiny`], and nodes that belong to no run.
    pub fn new(seed: u64) -> Self {
        let mut bench = Self::of_run(Hub::new(seed), tiny(), RunId::named("none"));
        bench.run = None;
        bench.recorded.push(topics::STRESS_SAMPLED);
        bench
    }

    /// Creates a bench with nodes of a run.
    pub(crate) fn of_run(hub: Hub, scene: Scene, run: RunId) -> Self {
        let recorded = REPRODUCIBLE.into_iter().chain([topics::RUN_STATE]).collect();
        Self { hub, record: Rc::default(), scene, run: Some(run), recorded }
    }

    /// Creates a bench whose network loses, repeats and delays messages.
    pub fn faulty(seed: u64) -> Self {
        let bench = Self::new(seed);
        let faults = Faults { drop: 0.1, duplicate: 0.2, delay: Duration::from_millis(30) };
        for topic in REPRODUCIBLE {
            bench.hub.set_faults(&topic.absolute_name(), faults);
        }
        bench
    }

    /// Creates a bus of a node outside of all runs.
    ///
    /// # Panics
    /// If `node` is no name of a node.
    pub fn bus(&self, node: &str) -> MemoryBus {
        self.hub.bus(Names::new(node).expect("a name"))
    }

    /// Creates a node with default settings, on its bus. A simulator resumes from the last packing of the record.
    ///
    /// # Errors
    /// Those of the node.
    pub(crate) fn start(&self, kind: Kind) -> Result<Actor, NodeError> {
        let names = Names::new(kind.name()).map_err(|e| NodeError::new(Exit::Usage, e.to_string()))?;
        let identity = self.run.map(|run| Identity::member_of(run, 1 + kind as u8));
        let mut bus = self.hub.bus_as(names, identity.unwrap_or_default());
        let node: Box<dyn Node> = match kind {
            Kind::Recorder => Box::new(MemoryRecorder::new(&mut bus, &self.recorded, &self.record)?),
            Kind::Inversion => Box::new(EmtInversion::new(&mut bus, Default::default())?),
            Kind::Analyzer => Box::new(FabricAnalyzer::new(&mut bus, Default::default())?),
            Kind::Servo => Box::new(ServoController::new(&mut bus, 1)?),
            Kind::Simulator => {
                let threads = std::num::NonZeroUsize::new(1);
                let settings = Settings { look_around: Duration::ZERO, threads, ..Settings::default() };
                let resume = self.record.borrow().last_packing();
                let simulator = DemSimulator::new(&mut bus, self.scene.clone(), resume, settings);
                Box::new(simulator.map_err(|e| NodeError::new(Exit::Failure, e.to_string()))?)
            }
        };
        Ok(Actor::new(node, bus))
    }

    /// Creates a node with default settings, on its bus.
    ///
    /// # Panics
    /// If the node cannot be created.
    pub fn node(&self, kind: Kind) -> Actor {
        self.start(kind).unwrap_or_else(|e| panic!("{kind:?}: {e}"))
    }

    /// Creates a simulator.
    ///
    /// # Panics
    /// If it cannot be created.
    pub fn simulator(&self, settings: &Settings, resume: Option<(Packing, Vec<u8>)>) -> Actor {
        let mut bus = self.bus("dem_simulator");
        let simulator = DemSimulator::new(&mut bus, self.scene.clone(), resume, settings.clone());
        Actor::new(Box::new(simulator.expect("a simulator")), bus)
    }

    /// Steps the nodes until `done`, or until none can go on; true in the first case.
    pub fn run(&self, actors: &mut [Actor], done: impl FnMut(&mut [Actor]) -> bool) -> bool {
        run_until(&self.hub, actors, FOREVER, done)
    }

    /// Steps the nodes for this time.
    pub fn pass(&self, actors: &mut [Actor], time: Duration) {
        run_until(&self.hub, actors, self.hub.now() + time, |_| false);
    }

    /// Runs the whole laboratory from beginning to end.
    ///
    /// # Panics
    /// If the run does not end.
    pub fn whole_run(self, settings: &Settings, resume: Option<(Packing, Vec<u8>)>) -> Record {
        let others = [Kind::Recorder, Kind::Analyzer, Kind::Inversion, Kind::Servo];
        let mut actors: Vec<Actor> = others.map(|kind| self.node(kind)).into();
        actors.push(self.simulator(settings, resume));
        let complete = self.run(&mut actors, |_| self.record.borrow().complete());
        let ends: Vec<_> = actors.iter().filter_map(|actor| actor.ended.as_ref()).collect();
        assert!(complete, "the run did not end; nodes ended: {ends:?}");
        // Messages in transit belong to the record.
        self.pass(&mut actors, Duration::from_secs(1));
        self.record.take()
    }
}

/// Returns the exit of an actor that has ended.
pub fn exit_of(actor: &Actor) -> Option<Exit> {
    actor.ended.as_ref().map(|end| end.as_ref().map_or_else(|failure| failure.exit, |exit| *exit))
}
