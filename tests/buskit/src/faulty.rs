//! A run under faults: its processes in one thread, and their restarts.

use crate::bench::{Bench, Kind};
use crate::plan::{Event, Plan};
use crate::process::Process;
use crate::record::Record;
use crate::stranger::Stranger;
use grainlab_node_kit::{Exit, Hub, Identity, MemoryBus, Names, RunId, run_of};
use grainlab_scene::Scene;
use serde::Serialize;
use std::iter::Peekable;
use std::time::Duration;
use std::vec::IntoIter;

/// Limit of the virtual time of a run.
const LIMIT: Duration = Duration::from_secs(3600);

/// Limit of the steps of processes.
const STEPS: u64 = 2_000_000;

/// Time for messages in transit to arrive.
const LAST_CALL: Duration = Duration::from_secs(2);

/// Maximum number of restarts of the simulator after one packing. The next crash ends the run, as in the
/// launcher.
const CRASHES_ALLOWED: usize = 3;

/// The outcome of a run.
#[derive(Debug)]
pub enum Outcome {
    /// The path is done, and its last packing is inverted.
    Finished(Box<Record>),
    /// It ended with an error that is reported to the user.
    Failed(String),
    /// No process can continue, or the run does not end.
    Stuck(String),
}

/// Counts of the faults in runs.
#[derive(Debug, Default, Serialize)]
pub struct Done {
    /// Crashes of processes.
    pub crashes: u64,
    /// Processes that were stopped for a while.
    pub stops: u64,
    /// Jumps of the clocks.
    pub jumps: u64,
    /// Forged messages.
    pub forged: u64,
}

struct Laboratory<'a> {
    bench: Bench,
    run: RunId,
    processes: Vec<Process>,
    strangers: Vec<Stranger<MemoryBus>>,
    events: Peekable<IntoIter<(u64, Event)>>,
    crashes: Vec<usize>,
    done: &'a mut Done,
    explain: bool,
}

/// Runs the scene under a plan, and counts its faults.
pub fn run_with(scene: &Scene, plan: &Plan, done: &mut Done, explain: bool) -> Outcome {
    let (hub, run) = (Hub::new(plan.bus), RunId::named("the run"));
    for topic in grainlab_msgs::topics::TOPICS {
        hub.set_faults(&topic.absolute_name(), plan.faults);
    }
    let mut laboratory = Laboratory {
        bench: Bench::of_run(hub, scene.clone(), run),
        run,
        processes: Vec::new(),
        strangers: Vec::new(),
        events: plan.events.clone().into_iter().peekable(),
        crashes: Vec::new(),
        done,
        explain,
    };
    let outcome = match laboratory.conduct(plan) {
        Ok(()) => {
            let record = laboratory.bench.record.take();
            match (record.contradictions, record.lacks()) {
                (0, None) => Outcome::Finished(Box::new(record)),
                (0, Some(lack)) => Outcome::Failed(format!("{lack}: exit 3")),
                (n, _) => Outcome::Failed(format!("{n} messages contradict what was recorded: exit 1")),
            }
        }
        Err(outcome) => outcome,
    };
    laboratory.done.forged += laboratory.strangers.iter().map(|s| s.forged).sum::<u64>();
    outcome
}

impl Laboratory<'_> {
    fn conduct(&mut self, plan: &Plan) -> Result<(), Outcome> {
        let failed = |e: &dyn std::fmt::Display| Outcome::Failed(e.to_string());
        for (number, stranger) in plan.strangers.iter().enumerate() {
            let seed = plan.bus ^ (number as u64 + 1) << 32;
            let identity = match stranger.of_a_run {
                true => Identity::member_of(RunId::named("another"), 1),
                false => Identity::default(),
            };
            let bus = self.bench.hub.bus_as(Names::new("stranger").map_err(|e| failed(&e))?, identity);
            let run = self.run;
            let of_the_run = move |writer: &[u8; 12]| run_of(writer) == Some(run);
            let joined = Stranger::join(bus, stranger.forgery, of_the_run, stranger.share, seed);
            let mut stranger = joined.map_err(|e| failed(&e))?;
            stranger.publish_early().map_err(|e| failed(&e))?;
            self.strangers.push(stranger);
        }
        for kind in Kind::ALL {
            let process = Process::start(kind, &self.bench).map_err(|e| failed(&e))?;
            self.processes.push(process);
        }
        self.advance(|lab| lab.bench.record.borrow().complete(), LIMIT)?;
        // Stopped processes continue, and messages in transit arrive.
        self.processes.iter_mut().for_each(|p| p.stopped_until = Duration::ZERO);
        self.events = Vec::new().into_iter().peekable();
        let end = self.bench.hub.now() + LAST_CALL;
        match self.advance(|_| false, end) {
            Err(Outcome::Stuck(_)) | Ok(()) => Ok(()),
            Err(outcome) => Err(outcome),
        }
    }

    /// Continues the run until `done`, an error, or virtual time `limit`.
    fn advance(&mut self, done: impl Fn(&Self) -> bool, limit: Duration) -> Result<(), Outcome> {
        let mut steps = 0;
        loop {
            let now = self.bench.hub.now();
            self.events_due()?;
            let mut stepped = self.restart(now)?;
            for stranger in &mut self.strangers {
                stepped |= stranger.step().map_err(|e| Outcome::Failed(e.to_string()))?;
            }
            for index in 0..self.processes.len() {
                stepped |= self.step(index, now)?;
            }
            if done(self) {
                return Ok(());
            }
            steps += 1;
            if steps > STEPS {
                return Err(Outcome::Stuck(self.describe("after millions of steps")));
            }
            if stepped {
                continue;
            }
            match self.next_moment(now) {
                Some(next) if next <= limit => self.bench.hub.advance(next.saturating_sub(now)),
                _ => return Err(Outcome::Stuck(self.describe("nothing is to come"))),
            }
        }
    }

    /// Time of the next event, if any.
    fn next_moment(&self, now: Duration) -> Option<Duration> {
        let of = |p: &Process| match &p.running {
            None => p.restart_at,
            Some(actor) => Some(actor.next_step(now)?.max(p.stopped_until)),
        };
        let processes = self.processes.iter().filter_map(of);
        processes.chain(self.bench.hub.next_arrival()).filter(|at| *at > now).min()
    }

    /// One step of a process that is due.
    fn step(&mut self, index: usize, now: Duration) -> Result<bool, Outcome> {
        let Process { kind, running: Some(actor), stopped_until, .. } = &mut self.processes[index] else {
            return Ok(false);
        };
        let stepped = *stopped_until <= now && actor.step(now);
        match &actor.ended {
            Some(Err(error)) if stepped => Err(Outcome::Failed(format!("{kind:?}: {error}"))),
            _ => Ok(stepped),
        }
    }

    fn restart(&mut self, now: Duration) -> Result<bool, Outcome> {
        let mut any = false;
        for index in 0..self.processes.len() {
            if self.processes[index].restart_at.is_none_or(|at| at > now) {
                continue;
            }
            any = true;
            let kind = self.processes[index].kind;
            let started = Process::start(kind, &self.bench);
            self.say(&format!("{kind:?} is started again"));
            self.processes[index] = started.map_err(|e| Outcome::Failed(e.to_string()))?;
        }
        Ok(any)
    }

    /// Applies the events that are due by the count of samples.
    fn events_due(&mut self) -> Result<(), Outcome> {
        loop {
            let seen = self.bench.record.borrow().seen;
            let Some((moment, event)) = self.events.next_if(|(moment, _)| *moment <= seen) else {
                return Ok(());
            };
            self.say(&format!("at sample {moment}: {event:?}"));
            self.happen(event)?;
        }
    }

    fn happen(&mut self, event: Event) -> Result<(), Outcome> {
        let now = self.bench.hub.now();
        match event {
            Event::Crash(kind, pause) => {
                self.done.crashes += 1;
                self.crash(kind, now + pause)?;
            }
            Event::Stop(kind, time) => {
                self.done.stops += 1;
                self.processes
                    .iter_mut()
                    .filter(|p| p.kind == kind)
                    .for_each(|p| p.stopped_until = now + time);
            }
            Event::Suspend(time) => {
                self.done.jumps += 1;
                self.bench.hub.advance(time);
            }
            Event::WallClock(seconds) => {
                self.done.jumps += 1;
                self.bench.hub.set_wall_clock(seconds * 1_000_000_000);
            }
        }
        Ok(())
    }

    fn crash(&mut self, kind: Kind, back_at: Duration) -> Result<(), Outcome> {
        let Some(process) = self.processes.iter_mut().find(|p| p.kind == kind) else { return Ok(()) };
        let Some(actor) = process.running.take() else { return Ok(()) };
        match kind {
            Kind::Recorder => return Err(Outcome::Failed("the recorder crashed: exit 3".to_owned())),
            Kind::Simulator if matches!(actor.ended, Some(Ok(Exit::Done))) => return Ok(()),
            Kind::Simulator => {
                let packings = self.bench.record.borrow().packings();
                self.crashes.push(packings);
                if self.crashes.iter().filter(|known| **known == packings).count() > CRASHES_ALLOWED {
                    return Err(Outcome::Failed("the simulator crashed too often: exit 1".to_owned()));
                }
            }
            _ => {}
        }
        process.restart_at = Some(back_at);
        Ok(())
    }

    fn describe(&self, why: &str) -> String {
        let crashed = self.processes.iter().filter(|p| p.running.is_none()).map(|p| p.kind);
        let record = self.bench.record.borrow();
        format!(
            "{why}: at {:.1} s, {} samples, state {:?}, not running: {:?}",
            self.bench.hub.now().as_secs_f64(),
            record.seen,
            record.state().map(|s| (s.state, s.step)),
            crashed.collect::<Vec<_>>()
        )
    }

    fn say(&self, text: &str) {
        if self.explain {
            grainlab_console::say!("  {:9.4} s  {text}", self.bench.hub.now().as_secs_f64());
        }
    }
}
