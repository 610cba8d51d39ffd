//! Runs the processes of a launch: restarts them, and ends the run.

use super::child::{Child, Ended, Run};
use super::followed::{Followed, Outline, Received};
use super::plan::NodePlan;
use super::stopped::Stopped;
use super::time_limit::TimeLimit;
use super::watch::{Event, Watch};
use crate::agreement::names_of_run;
use crate::last_packing;
use crate::nodes::NodeKind;
use grainlab_console::{Failure, worse};
use grainlab_node_kit::{Exit, Names};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::time::sleep;

/// A node that ends this often within this time is not restarted.
const RESTARTS: usize = 10;
const RESTART_WINDOW: Duration = Duration::from_secs(30);
/// Pause before a restart.
const RESTART_PAUSE: Duration = Duration::from_millis(100);

/// Period of the checks of the processes.
pub(super) const POLL_PERIOD: Duration = Duration::from_millis(200);

/// Time for a process that was stopped to catch up before the run ends, and the time limit of the end for it.
const CATCHES_UP_WITHIN: Duration = Duration::from_secs(6);
pub(super) const STOPPED_AT_MOST: Duration = Duration::from_secs(90);

/// Time before a message about a run that has not begun.
pub(super) const BEGINS_WITHIN: Duration = Duration::from_secs(10);

/// The recorder, whose end is the end of the record.
const RECORDER: NodeKind = NodeKind::Recorder;
/// The simulator, which continues from its last packing after a crash.
const SIMULATOR: NodeKind = NodeKind::DemSimulator;

/// A run from its first process to its last.
pub struct Supervisor {
    pub(super) children: Vec<Child>,
    run: Run,
    /// The names of the topics of the run.
    names: Names,
    pub(super) directory: PathBuf,
    pub(super) logs: PathBuf,
    pub(super) ended: UnboundedReceiver<Ended>,
    report_end: UnboundedSender<Ended>,
    pub(super) interrupt: Signal,
    pub(super) terminate: Signal,
    hangup: Signal,
    pub(super) followed: Followed,
    pub(super) stopped: Stopped,
    /// Number of recorded packings at each crash of the simulator.
    crashes: Vec<u64>,
    /// A third-party program failed.
    foreign_failure: bool,
}

/// The result of a run.
#[derive(Debug)]
pub struct Supervised {
    /// Exit of the run.
    pub exit: Exit,
    /// Why it is not [`Exit::Done`], one line each, as printed.
    pub reasons: Vec<String>,
    /// Every process with its last process id.
    pub children: Vec<Child>,
    /// From the first start to the last end.
    pub wall: Duration,
    /// The received messages of the run, which the recording must contain.
    pub received: Received,
}

impl Supervisor {
    /// Call this inside the runtime.
    pub fn new(plans: Vec<NodePlan>, run: Run, directory: &Path, outline: Outline) -> Result<Self, Failure> {
        let handler = |kind| signal(kind).map_err(|e| Failure::failed(format!("signal handler: {e}")));
        let (report_end, ended) = unbounded_channel();
        let followed = Followed::new(&plans, outline);
        let names = names_of_run(&plans).map_err(Failure::usage)?;
        Ok(Self {
            names,
            children: plans.into_iter().zip(1..).map(|(plan, member)| Child::new(plan, member)).collect(),
            run,
            directory: directory.to_owned(),
            logs: directory.join("logs"),
            ended,
            report_end,
            interrupt: handler(SignalKind::interrupt())?,
            terminate: handler(SignalKind::terminate())?,
            hangup: handler(SignalKind::hangup())?,
            followed,
            stopped: Stopped::default(),
            crashes: Vec::new(),
            foreign_failure: false,
        })
    }

    /// Starts every process, waits for the end, ends every process.
    pub async fn run(mut self) -> Result<Supervised, Failure> {
        let begin = Instant::now();
        let (watch, mut events) = Watch::start(self.run, self.names.clone(), self.member(SIMULATOR))?;
        // The watch starts first, so that it receives all messages.
        if let Some(event) = events.recv().await {
            self.followed.take(event);
        }
        let started = (0..self.children.len()).try_for_each(|index| self.start(index));
        let mut exit = match started {
            Ok(()) if self.followed.blind => Exit::Failure,
            Ok(()) => self.attend(&mut events).await,
            Err(failure) => {
                self.followed.complain(failure.to_string());
                failure.exit
            }
        };
        if self.end_all(exit, &mut events, &watch).await {
            exit = Exit::Interrupted;
        }
        exit = self.judge_recorder(exit);
        // A simulator that ended with an error fails the run, whatever was received before.
        let simulator = self.code(SIMULATOR).and_then(Exit::from_code).unwrap_or(Exit::Failure);
        if exit == Exit::Done && simulator != Exit::Done {
            self.followed.simulator_failed();
            exit = simulator;
        }
        if self.foreign_failure {
            exit = worse(exit, Exit::Failure);
        }
        drop(watch);
        let (reasons, received) = self.followed.received();
        Ok(Supervised { exit, reasons, children: self.children, wall: begin.elapsed(), received })
    }

    /// The exit code of a node that has ended by itself.
    pub(super) fn code(&self, node: NodeKind) -> Option<i32> {
        self.children.iter().find(|c| c.plan.is(node))?.code
    }

    fn member(&self, node: NodeKind) -> Option<u8> {
        self.children.iter().find(|c| c.plan.is(node)).map(|c| c.member)
    }

    fn start(&mut self, index: usize) -> Result<(), Failure> {
        self.children[index].start(index, &self.run, &self.logs, &self.report_end)
    }

    /// Follows the run until it is complete; the children still run then.
    async fn attend(&mut self, events: &mut UnboundedReceiver<Event>) -> Exit {
        let mut beginning = TimeLimit::new(BEGINS_WITHIN);
        loop {
            // Events take precedence over time limits.
            tokio::select! {
                biased;
                _ = self.interrupt.recv() => return self.interrupted("SIGINT"),
                _ = self.terminate.recv() => return self.interrupted("SIGTERM"),
                _ = self.hangup.recv() => return self.interrupted("SIGHUP"),
                event = events.recv() => {
                    self.followed.take(event.unwrap_or_else(|| Event::Failed("the watch ended".into())));
                    if self.followed.blind {
                        return Exit::Failure;
                    }
                }
                Some(ended) = self.ended.recv() => {
                    if let Some(exit) = self.on_end(&ended).await {
                        return exit;
                    }
                }
                () = sleep(POLL_PERIOD) => {
                    self.followed.progress.draw();
                    let suspended = self.look_for_stopped();
                    if !self.followed.begun && beginning.is_over(suspended) {
                        beginning = TimeLimit::new(BEGINS_WITHIN);
                        self.followed.say_what_is_waited_for();
                        // A program that failed does not come back.
                        if let Some(exit) = self.failed_before_the_run() {
                            return exit;
                        }
                    }
                    continue;
                }
            }
            match self.followed.verdict() {
                None => {}
                Some(Exit::Done) => return self.caught_up().await,
                Some(exit) => return exit,
            }
        }
    }

    /// Complains about a program that failed and is not restarted, in a run that has not begun.
    fn failed_before_the_run(&mut self) -> Option<Exit> {
        let failed = |c: &&Child| c.plan.node.is_none() && c.pid.is_none() && c.code != Some(0);
        let Child { plan, code, .. } = self.children.iter().find(failed)?;
        let how = code.map_or_else(|| "by a signal".to_owned(), |code| format!("with exit code {code}"));
        let name = &plan.name;
        let reason = format!("{name} ended {how} before the run began: the run ends. See logs/{name}.log");
        self.followed.complain(reason);
        Some(Exit::Failure)
    }

    /// Ends a complete run, but waits until a stopped process continues and has had time to catch up: its writers keep
    /// the samples it missed only until they leave.
    async fn caught_up(&mut self) -> Exit {
        if let Some(text) = self.followed.silent_programs() {
            // One that failed made the run incomplete.
            if self.children.iter().any(|c| c.plan.node.is_none() && !c.restarts.is_empty()) {
                self.followed.complain(text);
                self.foreign_failure = true;
            } else {
                self.followed.progress.say(&text);
            }
        }
        self.look_for_stopped();
        let behind = self.stopped.any_within(CATCHES_UP_WITHIN);
        let mut catching_up = TimeLimit::new(if behind { CATCHES_UP_WITHIN } else { Duration::ZERO });
        let mut waiting = TimeLimit::new(STOPPED_AT_MOST);
        loop {
            self.followed.progress.draw();
            let suspended = self.look_for_stopped();
            if catching_up.is_over(suspended) || waiting.is_over(false) {
                return Exit::Done;
            }
            tokio::select! {
                biased;
                _ = self.interrupt.recv() => return self.interrupted("SIGINT"),
                _ = self.terminate.recv() => return self.interrupted("SIGTERM"),
                _ = self.hangup.recv() => return self.interrupted("SIGHUP"),
                () = sleep(POLL_PERIOD) => {}
            }
        }
    }

    /// Prints once which processes are stopped or continue; true while any is stopped.
    pub(super) fn look_for_stopped(&mut self) -> bool {
        let changes = self.stopped.look(&self.children);
        for (name, pid) in changes.stopped {
            self.followed.progress.say(&format!(
                "{name} (pid {pid}) is stopped by a signal: waiting for it (kill -CONT {pid})"
            ));
        }
        for name in changes.resumed {
            self.followed.progress.say(&format!("{name} continues"));
        }
        self.stopped.any()
    }

    fn interrupted(&self, name: &str) -> Exit {
        self.followed.progress.say(&format!("{name}: ending every process and finishing the recording"));
        Exit::Interrupted
    }

    /// Handles a process that ended by itself; returns the exit of the run if this ends it.
    async fn on_end(&mut self, ended: &Ended) -> Option<Exit> {
        let how = self.note_end(ended);
        let child = &self.children[ended.index];
        let (name, node, code) = (child.plan.name.clone(), child.plan.node, child.code);
        let meant = code.and_then(Exit::from_code);
        let Some(node) = node else { return self.on_foreign_end(ended.index, &how).await };
        if node == SIMULATOR && self.followed.finished.is_some() && code == Some(0) {
            return None;
        }
        let exit = match (node, meant) {
            (_, Some(Exit::Usage)) => Exit::Usage,
            (RECORDER, _) => Exit::DataLoss,
            (SIMULATOR, Some(Exit::PhysicsInvalid)) => Exit::PhysicsInvalid,
            (SIMULATOR, None | Some(Exit::Failure)) => return self.resume(ended.index, &how).await,
            (SIMULATOR, _) => Exit::Failure,
            _ if child.plan.respawn => return self.restart(ended.index, &how).await,
            _ => Exit::Failure,
        };
        let reason = self.followed.failed.as_deref().filter(|_| node == SIMULATOR).unwrap_or("the run ends");
        let text = format!("{name} {how}: {reason}");
        Some(self.give_up(ended.index, text, exit))
    }

    /// Complains about a process, with the errors of its log.
    fn give_up(&mut self, index: usize, reason: String, exit: Exit) -> Exit {
        self.followed.complain(reason);
        self.children[index].quote_log(&self.logs);
        exit
    }

    /// A third-party program may end when it is done; one that fails does not end the run, but counts as a failure.
    async fn on_foreign_end(&mut self, index: usize, how: &str) -> Option<Exit> {
        let child = &self.children[index];
        if child.plan.respawn {
            return self.restart(index, how).await;
        }
        if child.code == Some(0) {
            self.followed.progress.say(&format!("{} {how}", child.plan.name));
        } else {
            self.followed.complain(format!("{name} {how}: see logs/{name}.log", name = child.plan.name));
            self.children[index].quote_log(&self.logs);
            self.foreign_failure = true;
        }
        None
    }

    /// Restarts the simulator from the last recorded packing; see `--resume`.
    async fn resume(&mut self, index: usize, how: &str) -> Option<Exit> {
        let packings = last_packing::count(&self.directory);
        self.crashes.push(packings);
        // Three attempts ended at the same packing: a fourth one would, too.
        if self.crashes.iter().filter(|known| **known == packings).count() > 3 {
            let again =
                format!("{SIMULATOR} {how}, for the fourth time after packing {packings}: not restarted");
            return Some(self.give_up(index, again, Exit::Failure));
        }
        self.children[index].quote_log(&self.logs);
        let from = if packings == 0 { "from the beginning" } else { "from the last packing recorded" };
        self.followed.progress.say(&format!("{SIMULATOR} {how}: the run continues {from}"));
        self.children[index].resume_from = (packings > 0).then(|| self.directory.clone());
        self.followed.finished = None;
        self.start_again(index).await
    }

    async fn restart(&mut self, index: usize, how: &str) -> Option<Exit> {
        let child = &mut self.children[index];
        let name = child.plan.name.clone();
        let now = Instant::now();
        let recent = child.restarts.iter().filter(|at| now.duration_since(**at) < RESTART_WINDOW).count() + 1;
        if recent > RESTARTS {
            let window = RESTART_WINDOW.as_secs();
            let again = format!("{name} {how}, {recent} times within {window} s: not restarted");
            return Some(self.give_up(index, again, Exit::Failure));
        }
        self.followed.progress.say(&format!("{name} {how}: restarted"));
        if self.children[index].plan.node.is_none() {
            self.children[index].quote_log(&self.logs);
        }
        self.start_again(index).await
    }

    async fn start_again(&mut self, index: usize) -> Option<Exit> {
        self.children[index].restarts.push(Instant::now());
        sleep(RESTART_PAUSE).await;
        let started = self.start(index);
        started.err().map(|failure| {
            self.followed.complain(failure.to_string());
            failure.exit
        })
    }
}
