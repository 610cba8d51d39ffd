//! Passes the run's messages over DDS to the supervisor.

use crate::child::Run;
use grainlab_console::{Failure, say};
use grainlab_core::notes::Status;
use grainlab_core::results::Estimate;
use grainlab_emt::recommended;
use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::msg::{Microstructure, Moduli, PackingReport, RunState, WaveSpeeds};
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{PhaseReport, Topic, stamp, topics};
use grainlab_node_kit::{
    Bus, BusError, DdsBus, Demand, Graph, Identity, Names, Participant, Report, Subscription, bus_named,
    member_of, watchdog,
};
use grainlab_recorder::strangers::name;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

/// Maximum number of queued messages; one arrives per second and at each end of a phase, and an instrument may send hundreds.
const BACKLOG: u32 = 1024;

/// Period at which the thread checks whether to end.
const POLL_PERIOD: Duration = Duration::from_millis(100);

/// Period at which it checks its DDS threads and the other processes in the domain.
const DISCOVERY_TIME: Duration = Duration::from_secs(1);

/// Time limit for its end: RustDDS may wait for threads that have ended.
const LEAVE_WITHIN: Duration = Duration::from_secs(2);

/// The member number of the launcher: none of its processes has it.
pub(crate) const LAUNCHER: u8 = u8::MAX;

/// Maximum number of messages about processes outside the run.
const NAMED: usize = 32;

/// Topics on which a process outside the run could publish.
const OF_THE_RUN: [Topic; 9] = [
    topics::STRESS,
    topics::STRAIN_RATE,
    topics::PACKING,
    topics::PACKING_REPORT,
    topics::MODULI,
    topics::WAVE_SPEEDS,
    topics::WAVEFORM,
    topics::MICROSTRUCTURE,
    topics::RUN_STATE,
];

/// An event for the supervisor.
#[derive(Debug)]
pub(crate) enum Event {
    /// The state of the run.
    State(RunState),
    /// The packing of this step was measured: its data were published on this topic.
    Measured {
        topic: &'static str,
        step: u64,
        /// They have the stamp of a packing that a run starts from, whose step is 0.
        has_first_stamp: bool,
    },
    /// The microstructure of the packing of this step was inferred from data of this topic; or, if no model has an estimate, why.
    Microstructure { source: String, step: u64, nothing: Option<String> },
    /// Progress of the present phase.
    Phase(PhaseReport),
    /// Activity of the simulator, or the condition that it waits for.
    Simulator(String),
    /// The process with this id sent its last report.
    Goodbye(u32),
    /// The bus is open: messages are received from now on.
    Open,
    /// The simulator was discovered.
    SimulatorJoined,
    /// The DDS domain is full, in words.
    Crowded(String),
    /// A process outside the run publishes on its topics.
    Stranger(String),
    /// The watch itself failed.
    Failed(String),
}

/// A thread with its own bus.
#[derive(Debug)]
pub(crate) struct Watch {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Watch {
    /// Joins the domain as a process of the run, with the names of its topics, and receives until it is dropped.
    ///
    /// `simulator` is the member number of the simulator: another process cannot end the run by a state.
    pub(crate) fn start(
        run: Run,
        names: Names,
        simulator: Option<u8>,
    ) -> Result<(Self, UnboundedReceiver<Event>), Failure> {
        let (events, receiver) = unbounded_channel();
        let stop = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stop);
        watchdog::watch_dds_threads();
        let thread = std::thread::Builder::new().name("watch".into()).spawn(move || {
            // The programs of the launcher are its descendants.
            let root = Some(std::process::id());
            let identity = Identity { root, ..Identity::member_of(run.id, LAUNCHER) };
            let bus = bus_named(run.domain, names.for_node("launcher"), identity);
            let watched = bus.map_err(|e| e.to_string()).and_then(|mut bus| {
                let watched = watch(&mut bus, &events, &asked, simulator);
                if watched.is_err() {
                    // Dropping the bus would wait for threads that have ended.
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

    /// Stops the thread; dropping waits for its end.
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

pub(crate) struct RunSubscriptions {
    states: Subscription<RunState>,
    simulator: Option<u8>,
    /// Other processes of the run that published a state.
    pretenders: BTreeSet<Participant>,
    packing_reports: Subscription<PackingReport>,
    moduli: Subscription<Moduli>,
    speeds: Subscription<WaveSpeeds>,
    microstructures: Subscription<Microstructure>,
    reports: Subscription<DiagnosticArray>,
}

impl RunSubscriptions {
    /// Subscribes. `simulator` is the member number of the simulator: another process cannot end the run by a state.
    pub(crate) fn new(bus: &mut dyn Bus, simulator: Option<u8>) -> Result<Self, BusError> {
        let demand = Demand::reliable(BACKLOG);
        let reports = Demand::best_effort(BACKLOG);
        Ok(Self {
            simulator,
            pretenders: BTreeSet::new(),
            states: Subscription::subscribe(bus, &topics::RUN_STATE, demand)?,
            packing_reports: Subscription::subscribe(bus, &topics::PACKING_REPORT, demand)?,
            moduli: Subscription::subscribe(bus, &topics::MODULI, demand)?,
            speeds: Subscription::subscribe(bus, &topics::WAVE_SPEEDS, demand)?,
            microstructures: Subscription::subscribe(bus, &topics::MICROSTRUCTURE, demand)?,
            reports: Subscription::subscribe(bus, &topics::DIAGNOSTICS, reports)?,
        })
    }

    /// Passes what arrived to `send`.
    pub(crate) fn receive(&mut self, bus: &mut dyn Bus, mut send: impl FnMut(Event)) -> Result<(), BusError> {
        while let Some((state, info)) = self.states.take_valid(bus)? {
            let who = info.writer.participant();
            if self.simulator.is_some_and(|member| member_of(&who) != member) {
                if self.pretenders.len() < NAMED && self.pretenders.insert(who) {
                    let name = bus.describe(info.writer);
                    say!(
                        "grainlab: {name} publishes run_state and is not the simulator of this run: it is ignored"
                    );
                }
                continue;
            }
            match state.checked().cloned() {
                Ok(state) => send(Event::State(state)),
                Err(e) => log::warn!("{e}"),
            }
        }
        while let Some((found, _)) = self.packing_reports.take_valid(bus)? {
            send(measured(&topics::PACKING_REPORT, found.source_step, &found.header));
        }
        while let Some((found, _)) = self.moduli.take_valid(bus)? {
            send(measured(&topics::MODULI, found.source_step, &found.header));
        }
        while let Some((found, _)) = self.speeds.take_valid(bus)? {
            send(measured(&topics::WAVE_SPEEDS, found.source_step, &found.header));
        }
        while let Some((found, _)) = self.microstructures.take_valid(bus)? {
            // The data say themselves that they have nothing to invert.
            if found.estimates.is_empty() {
                continue;
            }
            let nothing = without_estimate(&found);
            send(Event::Microstructure { source: found.source, step: found.source_step, nothing });
        }
        while let Some((message, _)) = self.reports.take_valid(bus)? {
            for report in Report::from_message(&message) {
                if let Some(phase) = report.health.phase() {
                    send(Event::Phase(phase));
                    send(Event::Simulator(report.health.message.clone()));
                }
                if report.is_final() {
                    send(Event::Goodbye(report.pid));
                }
            }
        }
        Ok(())
    }
}

fn measured(topic: &Topic, step: u64, header: &Header) -> Event {
    Event::Measured { topic: topic.name, step, has_first_stamp: header.stamp == stamp(0.0) }
}

fn watch(
    bus: &mut DdsBus,
    events: &UnboundedSender<Event>,
    stop: &AtomicBool,
    simulator: Option<u8>,
) -> Result<(), String> {
    // The receiver is closed only when the launcher ends.
    let send = |event| {
        let _ = events.send(event);
    };
    let mut subscriptions = RunSubscriptions::new(bus, simulator).map_err(|e| e.to_string())?;
    send(Event::Open);
    let (mut named, mut is_joined, mut is_crowded) = (BTreeSet::new(), false, false);
    let mut next_look = bus.now() + DISCOVERY_TIME;
    while !stop.load(Ordering::Relaxed) {
        subscriptions.receive(bus, send).map_err(|e| e.to_string())?;
        if bus.now() >= next_look {
            next_look = bus.now() + DISCOVERY_TIME;
            watchdog::check().map_err(|e| e.to_string())?;
            if !is_joined && has_joined(bus, simulator) {
                is_joined = true;
                send(Event::SimulatorJoined);
            }
            if !is_crowded && let Some(sentence) = bus.crowding() {
                is_crowded = true;
                send(Event::Crowded(sentence));
            }
            let of_the_run = OF_THE_RUN.iter().filter_map(|t| Some((bus.resolve(t).ok()?, t.name)));
            let of_the_run: BTreeMap<String, &str> = of_the_run.collect();
            for offer in bus.strange_offers() {
                let Some(topic) = of_the_run.get(&offer.topic) else { continue };
                let name = name(&bus.describe(offer.writer));
                if named.len() < NAMED && named.insert(name.clone()) {
                    send(Event::Stranger(format!("{name} publishes {topic} in this domain")));
                }
            }
        }
        bus.wait(POLL_PERIOD);
    }
    Ok(())
}

/// True if the simulator, the process with this member number, was discovered; without one, if any process publishes the state.
fn has_joined(bus: &DdsBus, simulator: Option<u8>) -> bool {
    let states = bus.foreign_writers(&topics::RUN_STATE);
    states.iter().any(|writer| simulator.is_none_or(|member| member_of(&writer.participant()) == member))
}

/// Returns why no estimate of a microstructure is recommended; `None` if one is.
fn without_estimate(found: &Microstructure) -> Option<String> {
    let estimates = match found.results() {
        Ok(estimates) => estimates,
        Err(refused) => return Some(refused.to_string()),
    };
    let asked = |status: fn(&Estimate) -> Status| {
        recommended(estimates.iter().map(|estimate| (estimate.model.as_str(), status(estimate))))
    };
    // The model whose estimate would be recommended; none of models that this program does not have.
    let preferred = asked(|_| Status::Ok);
    let is_answered = match preferred {
        Some(_) => asked(|estimate| estimate.status).is_some(),
        None => estimates.iter().any(|estimate| estimate.status != Status::Unknown),
    };
    if is_answered {
        return None;
    }
    let without = estimates.iter().find(|estimate| Some(estimate.model.as_str()) == preferred);
    let why = without.or(estimates.first()).and_then(|estimate| estimate.notes.first());
    Some(why.map_or_else(|| "no model was asked".to_owned(), ToString::to_string))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_to_refused_data_is_no_estimate() {
        use grainlab_msgs::msg::Estimate;
        let estimate = |status, warning: &str| Estimate {
            status,
            warnings: vec![warning.to_owned()],
            z: vec![5.0],
            gamma_over_delta_source: "none".to_owned(),
            ..Estimate::default()
        };
        let refused = || estimate(Estimate::STATUS_UNKNOWN, "speeds[0].speed = NaN is refused");
        let of = |estimates| without_estimate(&Microstructure { estimates, ..Microstructure::default() });
        assert_eq!(of(vec![refused(), refused()]).as_deref(), Some("speeds[0].speed = NaN is refused"));
        assert_eq!(of(vec![refused(), estimate(Estimate::STATUS_OK, "")]), None);
        assert!(of(Vec::new()).is_some());
        let by = |model: &str, e: Estimate| Estimate { model: model.to_owned(), ..e };
        let others =
            vec![by("relaxed", refused()), by("emt", estimate(Estimate::STATUS_EXTRAPOLATED, "far"))];
        assert_eq!(of(others).as_deref(), Some("speeds[0].speed = NaN is refused"), "emt is no substitute");
    }
}
