//! The analyzer over DDS, during an analysis. One test: the watchdog counts the DDS threads of the whole
//! process.

use grainlab_core::{Cell, Vec3};
use grainlab_fabric_analyzer::{FabricAnalyzer, MeasureError, Measured, Settings, measure};
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::msg::{Packing, PackingReport};
use grainlab_msgs::topics;
use grainlab_node_kit::{
    BulkPublisher, Bus, BusError, DdsBus, Demand, Exit, FreeDomain, Graph, Names, NodeError, Report,
    Subscription, drive,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

const TIME_LIMIT: Duration = Duration::from_secs(60);

/// The report of a grain alone with the step of the packing; the gate sets the duration.
fn measured(packing: &Packing) -> Result<Measured, MeasureError> {
    let alone = grainlab_core::Packing {
        step: packing.step,
        friction: 0.3,
        ..grainlab_core::Packing::at_rest(Cell::cube(1e-3).unwrap(), vec![1e-4], vec![Vec3::zeros()])
    };
    measure(&packing_message(&alone, "alone", Vec::new()), &Settings::default())
}

/// An analyzer whose measurements wait for its gate, and the messages received from it.
struct Scene {
    bus: DdsBus,
    packings: BulkPublisher,
    measured: Subscription<PackingReport>,
    reports: Subscription<DiagnosticArray>,
    gate: Sender<()>,
    stop: Arc<AtomicBool>,
    node: std::thread::JoinHandle<Exit>,
    begun: Instant,
    _domain: FreeDomain,
}

fn node(
    network: grainlab_node_kit::Network,
    gate: Receiver<()>,
    stop: &AtomicBool,
) -> Result<Exit, NodeError> {
    let mut bus = DdsBus::open(network, Names::new("fabric_analyzer").unwrap())?;
    let mut node = FabricAnalyzer::measuring(&mut bus, move |packing| {
        let _ = gate.recv();
        measured(packing)
    })?;
    let stop = || stop.load(Ordering::Relaxed);
    Ok(drive(&mut node, &mut bus, "/fabric_analyzer", None, &stop).expect("a bus that works"))
}

impl Scene {
    fn new() -> Self {
        let domain = FreeDomain::take().expect("a free DDS domain");
        let network = domain.network();
        let mut bus = DdsBus::open(network, Names::new("source").unwrap()).unwrap();
        let packings = BulkPublisher::advertise(&mut bus, &topics::PACKING).unwrap();
        let measured =
            Subscription::subscribe(&mut bus, &topics::PACKING_REPORT, Demand::reliable(64)).unwrap();
        let reports = Subscription::subscribe(&mut bus, &topics::DIAGNOSTICS, Demand::reliable(64)).unwrap();
        let (gate, waits) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stop);
        let node = std::thread::spawn(move || node(network, waits, &asked).expect("an analyzer"));
        let mut scene = Self {
            bus,
            packings,
            measured,
            reports,
            gate,
            stop,
            node,
            begun: Instant::now(),
            _domain: domain,
        };
        while scene.bus.readers(scene.packings.id()) == 0 {
            scene.pass("an analyzer");
        }
        scene
    }

    fn pass(&mut self, what: &str) {
        assert!(self.begun.elapsed() < TIME_LIMIT, "not within {TIME_LIMIT:?}: {what}");
        self.packings.advance(&mut self.bus).unwrap();
        self.bus.wait(Duration::from_millis(20));
    }

    fn publish(&mut self, packing: &Packing) {
        let body = grainlab_msgs::to_cdr(packing);
        loop {
            match self.packings.publish(&mut self.bus, &body) {
                Ok(()) => return,
                Err(BusError::Full { .. }) => self.pass("the packing before is delivered"),
                Err(error) => panic!("{error}"),
            }
        }
    }

    /// The next report of the analyzer.
    fn report(&mut self) -> Report {
        loop {
            if let Some((message, _)) = self.reports.take_valid(&mut self.bus).unwrap() {
                return Report::from_message(&message).pop().expect("a report");
            }
            self.pass("a heartbeat");
        }
    }

    fn measured(&mut self) -> u64 {
        loop {
            if let Some((report, _)) = self.measured.take_valid(&mut self.bus).unwrap() {
                return report.source_step;
            }
            self.pass("a report of a packing");
        }
    }
}

#[test]
fn an_analyzer_beats_while_it_analyses_answers_in_order_and_leaves_at_once() {
    let mut scene = Scene::new();
    let large = Packing { step: 1, position: vec![0.5; 700_000], ..Packing::default() };
    scene.publish(&large);
    let mut beats = 0;
    while beats < 3 {
        let report = scene.report();
        if report.health.message == "analysing the packing of step 1" {
            assert_eq!(report.health.value("analysing"), Some("1"));
            beats += 1;
        }
    }
    // A second large packing and a small one arrive while the first is analysed.
    scene.publish(&Packing { step: 2, ..large });
    scene.publish(&Packing { step: 3, ..Packing::default() });
    while scene.report().health.value("waiting") != Some("2") {}
    assert!(scene.measured.take_valid(&mut scene.bus).unwrap().is_none(), "the gate is closed");
    for step in 1..=3 {
        scene.gate.send(()).unwrap();
        assert_eq!(scene.measured(), step);
    }
    // Stopped in the middle of the next one, it ends without a result.
    scene.publish(&Packing { step: 4, ..Packing::default() });
    while scene.report().health.value("analysing") != Some("4") {}
    scene.stop.store(true, Ordering::Relaxed);
    assert_eq!(scene.node.join().unwrap(), Exit::Interrupted);
    assert!(scene.measured.take_valid(&mut scene.bus).unwrap().is_none());
}
