//! One process of the run, which may crash and be restarted.

use super::recorder::{MemoryRecorder, Record};
use grainlab_dem_simulator::DemSimulator;
use grainlab_emt_inversion::EmtInversion;
use grainlab_fabric_analyzer::FabricAnalyzer;
use grainlab_node_kit::{Exit, Hub, Identity, MemoryBus, Names, Node, NodeError, RunId};
use grainlab_scene::Scene;
use grainlab_servo_controller::ServoController;
use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

/// The kind of a process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Recorder,
    Inversion,
    Analyzer,
    Servo,
    Simulator,
}

impl Kind {
    pub(super) const ALL: [Kind; 5] =
        [Kind::Recorder, Kind::Inversion, Kind::Analyzer, Kind::Servo, Kind::Simulator];

    /// Member number in the run.
    pub(super) fn member(self) -> u8 {
        1 + self as u8
    }

    fn name(self) -> &'static str {
        ["recorder", "emt_inversion", "fabric_analyzer", "servo_controller", "dem_simulator"][self as usize]
    }
}

/// A node running on its bus.
pub(super) struct Process {
    pub(super) kind: Kind,
    /// `None` between a crash and the restart.
    pub(super) running: Option<(Box<dyn Node>, MemoryBus)>,
    /// Latest time of its next step.
    pub(super) due: Duration,
    /// Earliest time of its next step.
    pub(super) stopped_until: Duration,
    /// Time of its restart after a crash.
    pub(super) restart_at: Option<Duration>,
    pub(super) ended: Option<Exit>,
}

/// Arguments of a process.
pub(super) struct Start<'a> {
    pub(super) hub: &'a Hub,
    pub(super) run: RunId,
    pub(super) scene: &'a Scene,
    pub(super) record: &'a Rc<RefCell<Record>>,
}

impl Process {
    pub(super) fn start(kind: Kind, with: &Start) -> Result<Self, NodeError> {
        let names = Names::new(kind.name()).map_err(|e| NodeError::new(Exit::Usage, e.to_string()))?;
        let mut bus = with.hub.bus_as(names, Identity::member_of(with.run, kind.member()));
        let node: Box<dyn Node> = match kind {
            Kind::Recorder => Box::new(MemoryRecorder::new(&mut bus, with.record)?),
            Kind::Inversion => {
                Box::new(EmtInversion::new(&mut bus, grainlab_emt_inversion::Settings::default())?)
            }
            Kind::Analyzer => {
                Box::new(FabricAnalyzer::new(&mut bus, grainlab_fabric_analyzer::Settings::default())?)
            }
            Kind::Servo => Box::new(ServoController::new(&mut bus, 1)?),
            Kind::Simulator => {
                let settings = grainlab_dem_simulator::Settings {
                    look_around: Duration::ZERO,
                    threads: std::num::NonZeroUsize::new(1),
                    ..grainlab_dem_simulator::Settings::default()
                };
                let resume = with.record.borrow().last_packing();
                let simulator = DemSimulator::new(&mut bus, with.scene.clone(), resume, settings);
                Box::new(simulator.map_err(|e| NodeError::new(Exit::Failure, e.to_string()))?)
            }
        };
        Ok(Self {
            kind,
            running: Some((node, bus)),
            due: with.hub.now(),
            stopped_until: Duration::ZERO,
            restart_at: None,
            ended: None,
        })
    }
}
