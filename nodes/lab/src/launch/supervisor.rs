//! Who is restarted, and whose death ends the run.

use super::Run;
use super::child::{Child, Ended};
use super::deadline::{Deadline, nothing};
use super::debts::{Debts, Standing};
use super::patience::Patience;
use super::plan::NodePlan;
use super::progress::Progress;
use super::stopped::Stopped;
use super::watch::{Event, Watch};
use crate::failure::{Failure, worse};
use grainlab_msgs::boundary::{RunStateReading, RunStatus};
use grainlab_msgs::topics;
use grainlab_node_kit::Exit;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::time::sleep;

/// A node that ends this often within this time is not started again.
const RESTARTS: usize = 10;
const RESTART_WINDOW: Duration = Duration::from_secs(30);
/// Pause before a start after an end.
const RESTART_PAUSE: Duration = Duration::from_millis(100);

/// How often the processes are looked at.
const LOOK: Duration = Duration::from_millis(200);

/// How long a process that was stopped may take to catch up before the run ends, and how long the end waits for it.
const CATCHES_UP_WITHIN: Duration = Duration::from_secs(6);
const STOPPED_AT_MOST: Duration = Duration::from_secs(90);

/// How long a run that has not begun is silent about it.
const BEGINS_WITHIN: Duration = Duration::from_secs(10);

/// What a run waits for whose simulator was not heard yet.
const SEARCHING: &str = "its processes have not found each other";

/// The node whose end is the end of the record.
pub(super) const RECORDER: &str = "recorder";
/// The node that goes on from its last packing when it dies.
const SIMULATOR: &str = "dem_simulator";
/// The node that sends waves.
pub(super) const PROBE: &str = "acoustic_probe";
/// The node that infers.
pub(super) const INVERSION: &str = "emt_inversion";

/// A run from its first process to its last.
pub(crate) struct Supervisor {
    pub(super) children: Vec<Child>,
    run: Run,
    directory: PathBuf,
    logs: PathBuf,
    pub(super) ended: UnboundedReceiver<Ended>,
    report_end: UnboundedSender<Ended>,
    pub(super) interrupt: Signal,
    pub(super) terminate: Signal,
    hangup: Signal,
    pub(super) progress: Progress,
    /// The last packing is recorded within a phase: it need not have anything to measure.
    ends_within: bool,
    begun: bool,
    /// The step that the run began or went on at.
    first_step: Option<u64>,
    finished: Option<RunStateReading>,
    failed: Option<String>,
    /// The watch failed: nobody would notice the end of the run.
    blind: bool,
    debts: Debts,
    /// The probe was heard at work since the last look.
    probing: bool,
    pub(super) stopped: Stopped,
    /// Packings that were recorded each time the simulator died.
    deaths: Vec<u64>,
    /// A program that is not ours failed.
    foreign_failure: bool,
    /// Results that were heard, by topic: steps of packings.
    results: BTreeMap<&'static str, BTreeSet<u64>>,
    /// Processes that sent their last report.
    pub(super) left: BTreeSet<u32>,
}

/// What a run came to.
#[derive(Debug)]
pub(crate) struct Supervised {
    /// How it ended.
    pub(crate) exit: Exit,
    /// Every process with its last process id.
    pub(crate) children: Vec<Child>,
    /// From the first start to the last end.
    pub(crate) wall: Duration,
    /// What was heard of the run: has to be in the recording.
    pub(crate) heard: Heard,
}

/// What the run published, as the launcher heard it.
#[derive(Debug, Default)]
pub(crate) struct Heard {
    /// Packings, by the last run state; `None` if the path was not finished.
    pub(crate) packings: Option<u32>,
    /// Steps of the packings of which there is a result, by topic.
    pub(crate) results: BTreeMap<&'static str, BTreeSet<u64>>,
}

impl Supervisor {
    /// To be made inside the runtime.
    pub(crate) fn new(
        plans: Vec<NodePlan>,
        run: Run,
        directory: &Path,
        phases: usize,
        ends_within: bool,
    ) -> Result<Self, Failure> {
        let handler = |kind| signal(kind).map_err(|e| Failure::failed(format!("signal handler: {e}")));
        let (report_end, ended) = unbounded_channel();
        let debts = Debts::of(&plans);
        Ok(Self {
            children: plans.into_iter().zip(1..).map(|(plan, member)| Child::new(plan, member)).collect(),
            run,
            directory: directory.to_owned(),
            logs: directory.join("logs"),
            ended,
            report_end,
            interrupt: handler(SignalKind::interrupt())?,
            terminate: handler(SignalKind::terminate())?,
            hangup: handler(SignalKind::hangup())?,
            progress: Progress::new(phases),
            ends_within,
            begun: false,
            first_step: None,
            finished: None,
            failed: None,
            blind: false,
            debts,
            probing: false,
            stopped: Stopped::default(),
            deaths: Vec::new(),
            foreign_failure: false,
            results: BTreeMap::new(),
            left: BTreeSet::new(),
        })
    }

    /// Starts every process, waits for the end, ends every process.
    pub(crate) async fn run(mut self) -> Result<Supervised, Failure> {
        let begin = Instant::now();
        let (watch, mut events) = Watch::start(self.run)?;
        // Nothing that the processes say is missed.
        if let Some(event) = events.recv().await {
            self.take(event);
        }
        let mut exit = match self.start_all() {
            Ok(()) if self.blind => Exit::Failure,
            Ok(()) => self.attend(&mut events).await,
            Err(failure) => {
                crate::output::say!("grainlab: {failure}");
                failure.exit
            }
        };
        if self.end_all(exit, &mut events, &watch).await {
            exit = Exit::Interrupted;
        }
        let code = |node: &str| self.children.iter().find(|c| c.plan.is(node)).and_then(|c| c.code);
        if code(RECORDER) != Some(0) {
            // Data loss is in the table; anything else only the recorder can tell.
            if let Some(recorder) = self.children.iter().find(|c| c.plan.is(RECORDER) && c.code == Some(1)) {
                crate::output::say!("grainlab: {RECORDER} ended with exit code 1:");
                recorder.quote_log(&self.logs);
            }
            exit = worse(exit, Exit::DataLoss);
        }
        // A simulator that ended with an error fails the run, whatever was heard before.
        let simulator = code(SIMULATOR).and_then(Exit::from_code).unwrap_or(Exit::Failure);
        if exit == Exit::Done && simulator != Exit::Done {
            crate::output::say!("grainlab: {SIMULATOR} ended with exit code {}", simulator.code());
            exit = simulator;
        }
        if self.foreign_failure {
            exit = worse(exit, Exit::Failure);
        }
        drop(watch);
        let packings = self.finished.as_ref().map(|state| state.packings);
        let heard = Heard { packings, results: self.results };
        Ok(Supervised { exit, children: self.children, wall: begin.elapsed(), heard })
    }

    fn start_all(&mut self) -> Result<(), Failure> {
        (0..self.children.len()).try_for_each(|index| self.start(index))
    }

    fn start(&mut self, index: usize) -> Result<(), Failure> {
        self.children[index].start(index, &self.run, &self.logs, &self.report_end)
    }

    /// Follows the run until it is over; the children still run then.
    async fn attend(&mut self, events: &mut UnboundedReceiver<Event>) -> Exit {
        let mut deadline: Option<Deadline> = None;
        let mut beginning = Patience::new(BEGINS_WITHIN);
        loop {
            // What has happened comes before what has not happened in time.
            tokio::select! {
                biased;
                _ = self.interrupt.recv() => return self.interrupted("SIGINT"),
                _ = self.terminate.recv() => return self.interrupted("SIGTERM"),
                _ = self.hangup.recv() => return self.interrupted("SIGHUP"),
                event = events.recv() => {
                    self.take(event.unwrap_or_else(|| Event::Failed("the watch ended".into())));
                    if self.blind {
                        return Exit::Failure;
                    }
                }
                Some(ended) = self.ended.recv() => {
                    if let Some(exit) = self.on_end(&ended).await {
                        return exit;
                    }
                }
                () = sleep(LOOK) => {
                    let suspended = self.look_for_stopped();
                    if let Some(late) = deadline.as_mut()
                        && late.patience.is_over(suspended)
                    {
                        crate::output::say!("grainlab: {}", late.message);
                        return late.exit;
                    }
                    if !self.begun && beginning.is_over(suspended) {
                        beginning = Patience::new(BEGINS_WITHIN);
                        self.say_what_is_waited_for();
                    }
                    continue;
                }
            }
            let Some(last) = self.finished.as_ref().map(|s| s.last_packing_step) else { continue };
            let Some(step) = last else { return self.caught_up().await };
            match self.debts.standing(step) {
                Standing::Complete => return self.caught_up().await,
                Standing::Declined(_) if self.ends_within => return self.caught_up().await,
                Standing::Declined(node) => {
                    crate::output::say!("grainlab: the last packing has no {}", nothing(node));
                    return Exit::PhysicsInvalid;
                }
                standing => {
                    // Bursts through a long path take as long as they take; who is at work is waited for.
                    let at_work = std::mem::take(&mut self.probing) && standing == Standing::Open(PROBE);
                    if deadline.as_ref().is_none_or(|known| known.of != standing || at_work) {
                        let of = if self.ends_within { Deadline::within_a_phase } else { Deadline::of };
                        deadline = Some(of(standing));
                    }
                }
            }
        }
    }

    /// Ends a complete run, but not before a stopped process goes on and has had time to catch up: its writers keep what it
    /// missed only until they leave.
    async fn caught_up(&mut self) -> Exit {
        self.look_for_stopped();
        let behind = self.stopped.any_within(CATCHES_UP_WITHIN);
        let mut catching_up = Patience::new(if behind { CATCHES_UP_WITHIN } else { Duration::ZERO });
        let mut waiting = Patience::new(STOPPED_AT_MOST);
        loop {
            let suspended = self.look_for_stopped();
            if catching_up.is_over(suspended) || waiting.is_over(false) {
                return Exit::Done;
            }
            tokio::select! {
                biased;
                _ = self.interrupt.recv() => return self.interrupted("SIGINT"),
                _ = self.terminate.recv() => return self.interrupted("SIGTERM"),
                _ = self.hangup.recv() => return self.interrupted("SIGHUP"),
                () = sleep(LOOK) => {}
            }
        }
    }

    pub(super) fn take(&mut self, event: Event) {
        match event {
            Event::State(state) => {
                let first = *self.first_step.get_or_insert(state.step);
                self.begun |= state.step != first || state.status != RunStatus::Running;
                self.progress.show(&state);
                match state.status {
                    RunStatus::Running => {}
                    RunStatus::Finished => self.finished = Some(state),
                    RunStatus::Failed => self.failed = Some(state.message),
                }
            }
            Event::Goodbye(pid) => {
                self.left.insert(pid);
            }
            Event::Open => {}
            Event::Structure(step) => {
                self.heard(topics::FABRIC.name, step);
                self.debts.structure(step);
            }
            Event::Measured(topic, step) => {
                self.heard(topic, step);
                self.debts.measured(topic, step);
            }
            Event::Declined(topic, step) => self.debts.declined(topic, step),
            Event::Probing(step) => {
                self.probing = true;
                if self.finished.is_some() {
                    self.progress.still(&format!("waves are sent through the packing of step {step}"));
                }
            }
            Event::Microstructure { source, step, member } => {
                self.heard(topics::MICROSTRUCTURE.name, step);
                self.debts.inverted(&source, step, member);
                let data = source.replace('_', " ");
                self.progress.say(&match step {
                    // An instrument's data are of no packing of the run.
                    0 => format!("the {data} of an instrument inverted"),
                    _ => format!("packing of step {step} measured and inverted, by its {data}"),
                });
            }
            Event::Stranger(text) => {
                crate::output::say!("grainlab: {text} and is not of this run: it is ignored")
            }
            Event::Failed(message) => {
                crate::output::say!("grainlab: the launcher lost the bus: {message}: the run ends");
                self.blind = true;
            }
        }
    }

    /// An instrument's data are of no packing of the run.
    fn heard(&mut self, topic: &'static str, step: u64) {
        if step > 0 {
            self.results.entry(topic).or_default().insert(step);
        }
    }

    /// Says once who is stopped and who goes on; true while anyone is stopped.
    pub(super) fn look_for_stopped(&mut self) -> bool {
        let changes = self.stopped.look(&self.children);
        for (name, pid) in changes.stopped {
            self.progress.say(&format!(
                "{name} (pid {pid}) is stopped by a signal: waiting for it (kill -CONT {pid})"
            ));
        }
        for name in changes.resumed {
            self.progress.say(&format!("{name} goes on"));
        }
        self.stopped.any()
    }

    /// What the simulator says in its log that it waits for.
    fn say_what_is_waited_for(&self) {
        let simulator = self.children.iter().find(|c| c.plan.is(SIMULATOR));
        let waits = simulator.and_then(|c| c.last_line_if(&self.logs, "waiting for"));
        // A simulator that is heard and does not wait is at work on its first step.
        let Some(what) = waits.or_else(|| self.first_step.is_none().then(|| SEARCHING.to_owned())) else {
            return;
        };
        self.progress.say(&format!("the run has not begun: {what}"));
    }

    fn interrupted(&self, name: &str) -> Exit {
        self.progress.say(&format!("{name}: ending every process and finishing the recording"));
        Exit::Interrupted
    }

    /// A process ended by itself. How the run ends because of that, if it does.
    async fn on_end(&mut self, ended: &Ended) -> Option<Exit> {
        let how = self.note_end(ended);
        let child = &self.children[ended.index];
        let (name, node, code) = (child.plan.name.clone(), child.plan.node.clone(), child.code);
        let meant = code.and_then(Exit::from_code);
        let Some(node) = node else { return self.on_foreign_end(ended.index, &how).await };
        if node == SIMULATOR && self.finished.is_some() && code == Some(0) {
            return None;
        }
        let exit = match (node.as_str(), meant) {
            (_, Some(Exit::Usage)) => Exit::Usage,
            (RECORDER, _) => Exit::DataLoss,
            (SIMULATOR, Some(Exit::PhysicsInvalid)) => Exit::PhysicsInvalid,
            (SIMULATOR, None | Some(Exit::Failure)) => return self.resume(ended.index, &how).await,
            (SIMULATOR, _) => Exit::Failure,
            _ if child.plan.respawn => return self.restart(ended.index, &how).await,
            _ => Exit::Failure,
        };
        let reason = self.failed.as_deref().filter(|_| node == SIMULATOR).unwrap_or("the run ends");
        crate::output::say!("grainlab: {name} {how}: {reason}");
        self.children[ended.index].quote_log(&self.logs);
        Some(exit)
    }

    /// A program that is not ours may end when it is done; one that fails does not end the run, but it is no good end.
    async fn on_foreign_end(&mut self, index: usize, how: &str) -> Option<Exit> {
        let child = &self.children[index];
        if child.plan.respawn {
            return self.restart(index, how).await;
        }
        if !self.children.iter().any(|c| c.plan.node.is_none() && c.pid.is_some()) {
            self.debts.instruments_left();
        }
        if child.code == Some(0) {
            self.progress.say(&format!("{} {how}", child.plan.name));
        } else {
            crate::output::say!("grainlab: {} {how}: see logs/{}.log", child.plan.name, child.plan.name);
            self.foreign_failure = true;
        }
        None
    }

    /// Starts the simulator again, from the last packing that was recorded; see `--resume`.
    async fn resume(&mut self, index: usize, how: &str) -> Option<Exit> {
        let packings = crate::results::last_packing::count(&self.directory);
        self.deaths.push(packings);
        // It got no further in three attempts: the next one would not, either.
        if self.deaths.iter().filter(|known| **known == packings).count() > 3 {
            crate::output::say!(
                "grainlab: {SIMULATOR} {how}, for the fourth time behind packing {packings}: given up"
            );
            self.children[index].quote_log(&self.logs);
            return Some(Exit::Failure);
        }
        self.children[index].quote_log(&self.logs);
        let from = if packings == 0 { "from the beginning" } else { "from the last packing recorded" };
        self.progress.say(&format!("{SIMULATOR} {how}: the run goes on {from}"));
        self.children[index].resume_from = (packings > 0).then(|| self.directory.clone());
        self.finished = None;
        self.start_again(index).await
    }

    async fn restart(&mut self, index: usize, how: &str) -> Option<Exit> {
        let child = &mut self.children[index];
        let name = child.plan.name.clone();
        let now = Instant::now();
        let recent = child.restarts.iter().filter(|at| now.duration_since(**at) < RESTART_WINDOW).count() + 1;
        if recent > RESTARTS {
            crate::output::say!(
                "grainlab: {name} {how}, {recent} times within {} s: given up",
                RESTART_WINDOW.as_secs()
            );
            self.children[index].quote_log(&self.logs);
            return Some(Exit::Failure);
        }
        self.progress.say(&format!("{name} {how}: started again"));
        self.start_again(index).await
    }

    async fn start_again(&mut self, index: usize) -> Option<Exit> {
        self.children[index].restarts.push(Instant::now());
        sleep(RESTART_PAUSE).await;
        let started = self.start(index);
        started.err().map(|failure| {
            crate::output::say!("grainlab: {failure}");
            failure.exit
        })
    }
}
