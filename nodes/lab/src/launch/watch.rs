//! What the run says of itself over DDS, brought to the supervisor.

use super::Run;
use grainlab_acoustic_probe::{DECLINED_STEP, MEASURING};
use grainlab_console::Failure;
use grainlab_console::network::bus_as;
use grainlab_msgs::boundary::RunStateReading;
use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::msg::{Fabric, Microstructure, Moduli, RunState, WaveSpeeds};
use grainlab_msgs::{Topic, topics};
use grainlab_node_kit::identity::member_of;
use grainlab_node_kit::{Bus, BusError, DdsBus, Demand, Identity, Report, Stranger, Subscription, watchdog};
use grainlab_recorder::strangers::name;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

/// Messages that may wait; one comes a second and at each end of a phase.
const BACKLOG: u32 = 256;

/// How often the thread looks whether it is to end.
const LOOK: Duration = Duration::from_millis(100);

/// How often it looks whether its DDS threads are there, and who else is in the domain.
const LOOK_AROUND: Duration = Duration::from_secs(1);

/// How long its end is waited for: RustDDS may wait for threads that are gone.
const LEAVE_WITHIN: Duration = Duration::from_secs(2);

/// The place of the launcher in its run: no process that it starts has it.
const LAUNCHER: u8 = u8::MAX;

/// Strangers that are named one by one.
const NAMED: usize = 32;

/// Topics on which another process could say something about the run.
const OF_THE_RUN: [Topic; 9] = [
    topics::STRESS,
    topics::STRAIN_RATE,
    topics::PACKING,
    topics::FABRIC,
    topics::MODULI,
    topics::WAVE_SPEEDS,
    topics::WAVEFORM,
    topics::MICROSTRUCTURE,
    topics::RUN_STATE,
];

/// Something the supervisor has to know.
#[derive(Debug)]
pub(crate) enum Event {
    /// Where the run stands.
    State(RunStateReading),
    /// The structure of the packing of this step was measured.
    Structure(u64),
    /// The packing of this step was measured: its data of this topic are there.
    Measured(&'static str, u64),
    /// The packing of this step has nothing of this topic.
    Declined(&'static str, u64),
    /// An acoustic probe measures the packing of this step, which may take long.
    Probing(u64),
    /// The process in this place inferred the microstructure of the packing of this step from data of this topic.
    Microstructure { source: String, step: u64, member: u8 },
    /// The process of this id sent its last report.
    Goodbye(u32),
    /// The bus is open: what the processes say is heard from now on.
    Open,
    /// A process that is not of this run publishes on its topics.
    Stranger(String),
    /// The watch itself failed.
    Failed(String),
}

/// A thread with a bus of its own.
#[derive(Debug)]
pub(crate) struct Watch {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Watch {
    /// Joins the domain as a process of the run, and listens until it is dropped.
    pub(crate) fn start(run: Run) -> Result<(Self, UnboundedReceiver<Event>), Failure> {
        let (events, receiver) = unbounded_channel();
        let stop = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stop);
        watchdog::watch_dds_threads();
        let thread = std::thread::Builder::new().name("watch".into()).spawn(move || {
            // The programs that the launcher started are below it.
            let root = Some(std::process::id());
            let identity = Identity { root, ..Identity::member_of(run.id, LAUNCHER) };
            let bus = bus_as(run.domain, "launcher", identity);
            let watched = bus.map_err(|e| e.to_string()).and_then(|mut bus| {
                let watched = watch(&mut bus, &events, &asked);
                if watched.is_err() {
                    // Dropping the bus would wait for threads that are gone.
                    std::mem::forget(bus);
                }
                watched
            });
            if let Err(message) = watched {
                let _ = events.send(Event::Failed(message));
            }
        });
        let thread = Some(thread.map_err(|e| Failure::failed(format!("thread: {e}")))?);
        Ok((Self { stop, thread }, receiver))
    }

    /// Asks the thread to end; dropping waits for that.
    pub(crate) fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.stop();
        let Some(thread) = self.thread.take() else { return };
        let deadline = Instant::now() + LEAVE_WITHIN;
        while !thread.is_finished() && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(10));
        }
        if thread.is_finished() {
            let _ = thread.join();
        }
    }
}

/// Subscriptions to what a run says of itself.
struct Ears {
    states: Subscription<RunState>,
    fabrics: Subscription<Fabric>,
    moduli: Subscription<Moduli>,
    speeds: Subscription<WaveSpeeds>,
    microstructures: Subscription<Microstructure>,
    reports: Subscription<DiagnosticArray>,
}

impl Ears {
    fn new(bus: &mut dyn Bus) -> Result<Self, BusError> {
        let demand = Demand::reliable(BACKLOG);
        let heard = Demand::best_effort(BACKLOG);
        Ok(Self {
            states: Subscription::subscribe(bus, &topics::RUN_STATE, demand)?,
            fabrics: Subscription::subscribe(bus, &topics::FABRIC, demand)?,
            moduli: Subscription::subscribe(bus, &topics::MODULI, demand)?,
            speeds: Subscription::subscribe(bus, &topics::WAVE_SPEEDS, demand)?,
            microstructures: Subscription::subscribe(bus, &topics::MICROSTRUCTURE, demand)?,
            reports: Subscription::subscribe(bus, &topics::DIAGNOSTICS, heard)?,
        })
    }

    fn hear(&self, bus: &mut dyn Bus, mut send: impl FnMut(Event)) -> Result<(), BusError> {
        while let Some((state, _)) = self.states.take_valid(bus)? {
            match RunStateReading::try_from(&state) {
                Ok(reading) => send(Event::State(reading)),
                Err(e) => log::warn!("{e}"),
            }
        }
        while let Some((found, _)) = self.fabrics.take_valid(bus)? {
            send(Event::Structure(found.source_step));
        }
        while let Some((found, _)) = self.moduli.take_valid(bus)? {
            send(Event::Measured(topics::MODULI.name, found.source_step));
        }
        while let Some((found, _)) = self.speeds.take_valid(bus)? {
            send(Event::Measured(topics::WAVE_SPEEDS.name, found.source_step));
        }
        while let Some((found, info)) = self.microstructures.take_valid(bus)? {
            let member = member_of(&info.writer.participant());
            send(Event::Microstructure { source: found.source, step: found.source_step, member });
        }
        while let Some((message, _)) = self.reports.take_valid(bus)? {
            for report in Report::from_message(&message) {
                if let Some(step) = step_under(DECLINED_STEP, &report) {
                    send(Event::Declined(topics::WAVE_SPEEDS.name, step));
                }
                if let Some(step) = step_under(MEASURING, &report) {
                    send(Event::Probing(step));
                }
                if report.is_final() {
                    send(Event::Goodbye(report.pid));
                }
            }
        }
        Ok(())
    }
}

fn watch(bus: &mut DdsBus, events: &UnboundedSender<Event>, stop: &AtomicBool) -> Result<(), String> {
    // The receiver is closed only when the launcher ends.
    let send = |event| {
        let _ = events.send(event);
    };
    let ears = Ears::new(bus).map_err(|e| e.to_string())?;
    send(Event::Open);
    let mut named = BTreeSet::new();
    let mut next_look = bus.now() + LOOK_AROUND;
    while !stop.load(Ordering::Relaxed) {
        ears.hear(bus, send).map_err(|e| e.to_string())?;
        if bus.now() >= next_look {
            next_look = bus.now() + LOOK_AROUND;
            watchdog::check().map_err(|e| e.to_string())?;
            for (topic, stranger) in strangers(bus) {
                let name = name(&stranger);
                if named.len() < NAMED && named.insert(name.clone()) {
                    send(Event::Stranger(format!("{name} publishes {topic} in this domain")));
                }
            }
        }
        bus.wait(LOOK);
    }
    Ok(())
}

/// Who publishes on the topics of the run and is not of it.
fn strangers(bus: &dyn Bus) -> Vec<(&'static str, Stranger)> {
    let of = |topic: &Topic| {
        bus.strange_writers(topic).into_iter().map(|w| (topic.name, bus.describe(w))).collect()
    };
    OF_THE_RUN.iter().flat_map(|topic| -> Vec<_> { of(topic) }).collect()
}

/// The step that an acoustic probe reports under this key, if it does.
fn step_under(key: &str, report: &Report) -> Option<u64> {
    let (_, step) = report.health.values.iter().find(|(k, _)| k == key)?;
    step.parse().ok()
}
