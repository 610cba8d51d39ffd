//! What the run says of itself over DDS, brought to the supervisor.

use crate::failure::Failure;
use crate::network::bus_in;
use acoustic_probe::{DECLINED_STEP, MEASURING};
use grainlab_msgs::boundary::RunStateReading;
use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::msg::{Fabric, Microstructure, RunState, WaveSpeeds};
use grainlab_msgs::topics;
use node_kit::{Bus, BusError, DdsBus, Demand, Report, Subscription, WriterId};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

/// Messages that may wait; one comes a second and at each end of a phase.
const BACKLOG: u32 = 256;

/// How often the thread looks whether it is to end.
const LOOK: Duration = Duration::from_millis(100);

/// How long another run in the same domain is looked for: three times what discovery takes.
const LOOK_AROUND: Duration = Duration::from_millis(600);

/// Something the supervisor has to know.
#[derive(Debug)]
pub(crate) enum Event {
    /// Where the run stands.
    State(RunStateReading),
    /// The packing of this step was measured: everything that it has of this topic is there.
    Measured(&'static str, u64),
    /// The packing of this step has nothing of this topic.
    Declined(&'static str, u64),
    /// An acoustic probe measures the packing of this step, which may take long.
    Probing(u64),
    /// The microstructure of the packing of this step was inferred from data of this topic.
    Microstructure(String, u64),
    /// The process of this id said its last word.
    Goodbye(u32),
    /// Nobody else simulates in this domain; the first event, unless a rival does.
    Clear,
    /// Another run's writer of stress.
    Rival(WriterId),
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
    /// Joins the domain and listens until it is dropped. Another run is not looked for where we are `alone`.
    pub(crate) fn start(domain: u16, alone: bool) -> Result<(Self, UnboundedReceiver<Event>), Failure> {
        let (events, receiver) = unbounded_channel();
        let stop = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stop);
        let thread = std::thread::Builder::new().name("watch".into()).spawn(move || {
            let watched = bus_in(domain, "launcher")
                .map_err(|e| e.to_string())
                .and_then(|mut bus| watch(&mut bus, alone, &events, &asked).map_err(|e| e.to_string()));
            if let Err(message) = watched {
                let _ = events.send(Event::Failed(message));
            }
        });
        let thread = Some(thread.map_err(|e| Failure::failed(format!("thread: {e}")))?);
        Ok((Self { stop, thread }, receiver))
    }
}

impl Watch {
    /// Asks the thread to end; dropping waits for that.
    pub(crate) fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.stop();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn watch(
    bus: &mut DdsBus,
    alone: bool,
    events: &UnboundedSender<Event>,
    stop: &AtomicBool,
) -> Result<(), BusError> {
    let demand = Demand::reliable(BACKLOG);
    let states = Subscription::<RunState>::subscribe(bus, &topics::RUN_STATE, demand)?;
    let fabrics = Subscription::<Fabric>::subscribe(bus, &topics::FABRIC, demand)?;
    let speeds = Subscription::<WaveSpeeds>::subscribe(bus, &topics::WAVE_SPEEDS, demand)?;
    let microstructures = Subscription::<Microstructure>::subscribe(bus, &topics::MICROSTRUCTURE, demand)?;
    let heard = Demand::best_effort(BACKLOG);
    let reports = Subscription::<DiagnosticArray>::subscribe(bus, &topics::DIAGNOSTICS, heard)?;
    let look = if alone { bus.now() } else { bus.now() + LOOK_AROUND };
    while bus.now() < look && !stop.load(Ordering::Relaxed) {
        bus.wait(look.saturating_sub(bus.now()));
        // A latched state, before anything of ours runs, is of another run.
        if let Some(writer) = bus.foreign_writers(&topics::STRESS).first() {
            send(events, Event::Rival(*writer));
            return Ok(());
        }
    }
    send(events, Event::Clear);
    while !stop.load(Ordering::Relaxed) {
        while let Some((state, _)) = states.take_valid(bus)? {
            match RunStateReading::try_from(&state) {
                Ok(reading) => send(events, Event::State(reading)),
                Err(e) => log::warn!("{e}"),
            }
        }
        while let Some((fabric, _)) = fabrics.take_valid(bus)? {
            send(events, Event::Measured(topics::MODULI.name, fabric.source_step));
        }
        while let Some((found, _)) = speeds.take_valid(bus)? {
            send(events, Event::Measured(topics::WAVE_SPEEDS.name, found.source_step));
        }
        while let Some((found, _)) = microstructures.take_valid(bus)? {
            send(events, Event::Microstructure(found.source, found.source_step));
        }
        while let Some((message, _)) = reports.take_valid(bus)? {
            for report in Report::from_message(&message) {
                if let Some(step) = step_under(DECLINED_STEP, &report) {
                    send(events, Event::Declined(topics::WAVE_SPEEDS.name, step));
                }
                if let Some(step) = step_under(MEASURING, &report) {
                    send(events, Event::Probing(step));
                }
                if report.is_final() {
                    send(events, Event::Goodbye(report.pid));
                }
            }
        }
        bus.wait(LOOK);
    }
    Ok(())
}

/// The step that an acoustic probe reports under this key, if it does.
fn step_under(key: &str, report: &Report) -> Option<u64> {
    let (_, step) = report.health.values.iter().find(|(k, _)| k == key)?;
    step.parse().ok()
}

/// Nobody listens any more only when the launcher ends.
fn send(events: &UnboundedSender<Event>, event: Event) {
    let _ = events.send(event);
}
