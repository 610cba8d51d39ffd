//! Who is restarted, whose death ends the run, and in which order all end.

use super::child::{Child, Ended};
use super::debts::{Debts, Standing};
use super::plan::NodePlan;
use super::progress::Progress;
use super::watch::{Event, Watch};
use crate::failure::{Failure, worse};
use grainlab_msgs::boundary::{RunStateReading, RunStatus};
use node_kit::Exit;
use std::collections::BTreeSet;
use std::path::Path;
use std::time::{Duration, Instant};
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::time::{sleep, sleep_until, timeout};

/// A node that ends this often within this time is not started again.
const RESTARTS: usize = 10;
const RESTART_WINDOW: Duration = Duration::from_secs(30);
/// Pause before a start after an end.
const RESTART_PAUSE: Duration = Duration::from_millis(100);

/// How long the last packing may take to be measured, and what was measured to be inverted.
const MEASURED_WITHIN: Duration = Duration::from_secs(600);
const INVERTED_WITHIN: Duration = Duration::from_secs(10);

/// How long a process that was asked to end may take before it is asked again, more firmly.
const PATIENCE: Duration = Duration::from_secs(5);

/// The node whose end is the end of the record.
const RECORDER: &str = "recorder";
/// The node whose end is the end of the run.
const SIMULATOR: &str = "dem_simulator";
/// The node that sends waves.
const PROBE: &str = "acoustic_probe";

/// A run from its first process to its last.
pub(crate) struct Supervisor<'a> {
    children: Vec<Child>,
    domain: u16,
    /// Nobody else can be in the domain.
    alone: bool,
    logs: &'a Path,
    ended: UnboundedReceiver<Ended>,
    report_end: UnboundedSender<Ended>,
    interrupt: Signal,
    terminate: Signal,
    hangup: Signal,
    progress: Progress,
    finished: Option<RunStateReading>,
    failed: Option<String>,
    /// The watch failed: nobody would notice the end of the run.
    blind: bool,
    debts: Debts,
    /// The probe was heard at work since the last look.
    probing: bool,
    /// Processes that said their last word.
    left: BTreeSet<u32>,
}

/// The three steps of an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ending {
    /// Every node is asked to end and says its last word, which belongs into the recording.
    Farewell,
    /// The recorder ends.
    Record,
    /// Nobody is asked any more; what still runs goes.
    Exit,
}

/// What a run came to.
#[derive(Debug)]
pub(crate) struct Supervised {
    /// How it ended.
    pub(crate) exit: Exit,
    /// Every node with its last process.
    pub(crate) children: Vec<Child>,
    /// From the first start to the last end.
    pub(crate) wall: Duration,
}

impl<'a> Supervisor<'a> {
    /// To be made inside the runtime.
    pub(crate) fn new(
        plans: Vec<NodePlan>,
        domain: u16,
        alone: bool,
        logs: &'a Path,
        phases: usize,
    ) -> Result<Self, Failure> {
        let handler = |kind| signal(kind).map_err(|e| Failure::failed(format!("signal handler: {e}")));
        let (report_end, ended) = unbounded_channel();
        let debts = Debts::of(&plans);
        Ok(Self {
            children: plans.into_iter().map(Child::new).collect(),
            domain,
            alone,
            logs,
            ended,
            report_end,
            interrupt: handler(SignalKind::interrupt())?,
            terminate: handler(SignalKind::terminate())?,
            hangup: handler(SignalKind::hangup())?,
            progress: Progress::new(phases),
            finished: None,
            failed: None,
            blind: false,
            debts,
            probing: false,
            left: BTreeSet::new(),
        })
    }

    /// Starts every node, waits for the end, ends every node.
    pub(crate) async fn run(mut self) -> Result<Supervised, Failure> {
        let begin = Instant::now();
        let (watch, mut events) = Watch::start(self.domain, self.alone)?;
        if let Some(Event::Rival(writer)) = events.recv().await.filter(|e| matches!(e, Event::Rival(_))) {
            // Left to the end of the process: RustDDS may panic where a participant leaves in the midst of discovery.
            std::mem::forget(watch);
            return Err(Failure::failed(format!(
                "a run is already under way in DDS domain {} (writer {writer} of stress): end it, or unset ROS_DOMAIN_ID \
                 to get a domain of its own",
                self.domain
            )));
        }
        let mut exit = match self.start_all() {
            Ok(()) => self.attend(&mut events).await,
            Err(failure) => {
                crate::output::say!("grainlab: {failure}");
                failure.exit
            }
        };
        for ending in [Ending::Farewell, Ending::Record, Ending::Exit] {
            if self.end(ending, &mut events).await {
                exit = Exit::Interrupted;
            }
            // It leaves while the processes do.
            watch.stop();
        }
        let recorder = self.children.iter().find(|c| c.plan.node == RECORDER).and_then(|c| c.code);
        if recorder != Some(0) {
            exit = worse(exit, Exit::DataLoss);
        }
        drop(watch);
        Ok(Supervised { exit, children: self.children, wall: begin.elapsed() })
    }

    fn start_all(&mut self) -> Result<(), Failure> {
        (0..self.children.len()).try_for_each(|index| self.start(index))
    }

    fn start(&mut self, index: usize) -> Result<(), Failure> {
        self.children[index].start(index, self.domain, self.logs, &self.report_end)
    }

    /// Follows the run until it is over; the children still run then.
    async fn attend(&mut self, events: &mut UnboundedReceiver<Event>) -> Exit {
        let mut deadline: Option<(tokio::time::Instant, Exit, String)> = None;
        loop {
            let due =
                deadline.as_ref().map_or_else(|| tokio::time::Instant::now() + PATIENCE, |(at, ..)| *at);
            tokio::select! {
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
                _ = self.interrupt.recv() => return self.interrupted("SIGINT"),
                _ = self.terminate.recv() => return self.interrupted("SIGTERM"),
                _ = self.hangup.recv() => return self.interrupted("SIGHUP"),
                () = sleep_until(due) => {
                    if let Some((_, exit, message)) = deadline {
                        crate::output::say!("grainlab: {message}");
                        return exit;
                    }
                }
            }
            let Some(last) = self.finished.as_ref().map(|s| s.last_packing_step) else { continue };
            let Some(step) = last else { return Exit::Done };
            let now = tokio::time::Instant::now();
            let probing = std::mem::take(&mut self.probing);
            deadline = match (self.debts.standing(step), deadline) {
                (Standing::Complete, _) => return Exit::Done,
                (Standing::Declined(node), _) => {
                    crate::output::say!("grainlab: the last packing has no {}", nothing(node));
                    return Exit::PhysicsInvalid;
                }
                (Standing::Measured(_), Some(known @ (_, Exit::PhysicsInvalid, _))) => Some(known),
                (Standing::Measured(node), _) => {
                    let message = format!("the last packing has no {}", nothing(node));
                    Some((now + INVERTED_WITHIN, Exit::PhysicsInvalid, message))
                }
                // Bursts through a long path take as long as they take; who is at work is waited for.
                (Standing::Open(node), Some(known @ (_, Exit::Failure, _)))
                    if !(probing && node == PROBE) =>
                {
                    Some(known)
                }
                (Standing::Open(node), _) => {
                    let message = format!("the last packing was not measured: see logs/{node}.log");
                    Some((now + MEASURED_WITHIN, Exit::Failure, message))
                }
            };
        }
    }

    fn take(&mut self, event: Event) {
        match event {
            Event::State(state) => {
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
            Event::Clear | Event::Rival(_) => {}
            Event::Measured(topic, step) => self.debts.measured(topic, step),
            Event::Declined(topic, step) => self.debts.declined(topic, step),
            Event::Probing(step) => {
                self.probing = true;
                if self.finished.is_some() {
                    self.progress.still(&format!("waves are sent through the packing of step {step}"));
                }
            }
            Event::Microstructure(source, step) => {
                self.debts.inverted(&source, step);
                let data = source.replace('_', " ");
                self.progress.say(&format!("packing of step {step} measured and inverted, by its {data}"));
            }
            Event::Failed(message) => {
                crate::output::say!("grainlab: the launcher lost the bus: {message}: the run ends");
                self.blind = true;
            }
        }
    }

    fn interrupted(&self, name: &str) -> Exit {
        self.progress.say(&format!("{name}: ending every process and finishing the recording"));
        Exit::Interrupted
    }

    /// A process ended by itself. How the run ends because of that, if it does.
    async fn on_end(&mut self, ended: &Ended) -> Option<Exit> {
        let how = self.note_end(ended);
        let child = &self.children[ended.index];
        let (name, node, code) = (child.plan.name.clone(), child.plan.node.as_str(), child.code);
        let meant = code.and_then(Exit::from_code);
        if node == SIMULATOR && self.finished.is_some() && code == Some(0) {
            return None;
        }
        let exit = match (node, meant) {
            (_, Some(Exit::Usage)) => Exit::Usage,
            (RECORDER, _) => Exit::DataLoss,
            (SIMULATOR, Some(Exit::PhysicsInvalid)) => Exit::PhysicsInvalid,
            (SIMULATOR, _) => Exit::Failure,
            _ if child.plan.respawn => return self.restart(ended.index, &how).await,
            _ => Exit::Failure,
        };
        let reason = self.failed.as_deref().filter(|_| node == SIMULATOR).unwrap_or("the run ends");
        crate::output::say!("grainlab: {name} {how}: {reason}");
        self.children[ended.index].quote_log(self.logs);
        Some(exit)
    }

    async fn restart(&mut self, index: usize, how: &str) -> Option<Exit> {
        let child = &mut self.children[index];
        let name = child.plan.name.clone();
        let now = Instant::now();
        child.restarts.push(now);
        let recent = child.restarts.iter().filter(|at| now.duration_since(**at) < RESTART_WINDOW).count();
        if recent > RESTARTS {
            crate::output::say!(
                "grainlab: {name} {how}, {recent} times within {} s: given up",
                RESTART_WINDOW.as_secs()
            );
            self.children[index].quote_log(self.logs);
            return Some(Exit::Failure);
        }
        self.progress.say(&format!("{name} {how}: started again"));
        sleep(RESTART_PAUSE).await;
        let started = self.start(index);
        started.err().map(|failure| {
            crate::output::say!("grainlab: {failure}");
            failure.exit
        })
    }

    /// Books an end and says how it came.
    fn note_end(&mut self, ended: &Ended) -> String {
        use std::os::unix::process::ExitStatusExt;
        let child = &mut self.children[ended.index];
        child.pid = None;
        match &ended.status {
            Ok(status) => {
                child.code = status.code();
                match (status.code(), status.signal()) {
                    (Some(code), _) => format!("ended with exit code {code}"),
                    (None, Some(signal)) => format!("was ended by signal {signal}"),
                    (None, None) => "ended".to_owned(),
                }
            }
            Err(error) => format!("cannot be waited for ({error})"),
        }
    }

    /// Whether an end still waits for this child.
    fn awaits(&self, child: &Child, ending: Ending) -> bool {
        let recorder = child.plan.node == RECORDER;
        match (ending, child.pid) {
            (_, None) => false,
            (Ending::Farewell, Some(pid)) => !recorder && !self.left.contains(&pid),
            (Ending::Record, _) => recorder,
            (Ending::Exit, _) => true,
        }
    }

    /// Takes one step of the end: SIGINT, SIGTERM, SIGKILL, each a while after the other. True if the user asked to hurry,
    /// which kills what is left.
    async fn end(&mut self, ending: Ending, events: &mut UnboundedReceiver<Event>) -> bool {
        let mut hurried = false;
        for signal in [libc::SIGINT, libc::SIGTERM, libc::SIGKILL] {
            let signal = if hurried { libc::SIGKILL } else { signal };
            // Who said its last word was asked already, and a second signal would end it at once.
            if ending != Ending::Exit || signal != libc::SIGINT {
                self.children.iter().filter(|c| self.awaits(c, ending)).for_each(|c| c.signal(signal));
            }
            let running = |s: &Self| s.children.iter().any(|c| s.awaits(c, ending));
            let deadline = tokio::time::Instant::now() + PATIENCE;
            while running(self) && !hurried {
                tokio::select! {
                    Some(ended) = self.ended.recv() => { self.note_end(&ended); }
                    Some(event) = events.recv() => self.take(event),
                    _ = self.interrupt.recv() => hurried = true,
                    _ = self.terminate.recv() => hurried = true,
                    () = sleep_until(deadline) => break,
                }
            }
            if !running(self) {
                return hurried;
            }
            if hurried && signal == libc::SIGKILL {
                while running(self) {
                    let Ok(Some(ended)) = timeout(PATIENCE, self.ended.recv()).await else { break };
                    self.note_end(&ended);
                }
            }
        }
        hurried
    }
}

/// What a node did not find of a packing, and where it says why.
fn nothing(node: &str) -> String {
    let data = if node == PROBE { "wave speeds" } else { "stiffness" };
    format!("{data} to invert: see logs/{node}.log")
}
