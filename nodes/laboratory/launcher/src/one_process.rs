//! All nodes of a launch file in this process, over the bus in memory.
//!
//! The messages are those of separate processes, byte for byte. What separate processes add is missing: a node that crashes ends
//! the run, and other programs cannot take part.

use super::child::{Child, open_log};
use super::followed::{Followed, Outline};
use super::plan::{NodePlan, PlanError};
use super::supervisor::{BEGINS_WITHIN, POLL_PERIOD, Supervised};
use super::time_limit::TimeLimit;
use super::watch::{Event, LAUNCHER, RunSubscriptions};
use crate::agreement::names_of_run;
use crate::nodes::NodeKind;
use grainlab_console::{Failure, Signals, worse};
use grainlab_node_kit::{Component, Exit, Hub, Identity, Logger, MemoryBus, RosArgs, RunId, step_all};
use grainlab_recorder::ResultSlot;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Refuses a launch file that starts third-party programs, which are processes of their own, or gives a node an environment.
///
/// # Errors
/// If there is one; the text names it.
pub fn check_one_process(plans: &[NodePlan]) -> Result<(), PlanError> {
    let reason =
        "one process has no other programs: launch without --one-process, or the campaign with --processes";
    if let Some(plan) = plans.iter().find(|p| p.node.is_none()) {
        return Err(PlanError::of(&plan.name, reason));
    }
    let shared = "set_env has no effect in one process, whose nodes share one environment: launch without --one-process";
    plans.iter().find(|p| !p.environment.is_empty()).map_or(Ok(()), |p| Err(PlanError::of(&p.name, shared)))
}

/// A run whose nodes are steps of one thread.
struct OneProcess {
    hub: Hub,
    bus: MemoryBus,
    subscriptions: RunSubscriptions,
    signals: Signals,
    followed: Followed,
    children: Vec<Child>,
    components: Vec<Component>,
    logs: PathBuf,
}

/// Runs every node in this process until the run is complete, and ends them in order.
///
/// # Errors
/// Invalid plans, and logs that cannot be written. The failure of a node is a result.
pub fn run_in_one_process(
    plans: Vec<NodePlan>,
    run: RunId,
    directory: &Path,
    outline: Outline,
) -> Result<Supervised, Failure> {
    check_one_process(&plans).map_err(Failure::usage)?;
    let begin = Instant::now();
    let signals = Signals::install().map_err(Failure::failed)?;
    let hub = Hub::real_time(signals.flag());
    let names = names_of_run(&plans).map_err(Failure::usage)?;
    let root = Some(std::process::id());
    let mut bus =
        hub.bus_as(names.for_node("launcher"), Identity { root, ..Identity::member_of(run, LAUNCHER) });
    let followed = Followed::new(&plans, outline);
    let children: Vec<Child> = plans.into_iter().zip(1..).map(|(plan, n)| Child::new(plan, n)).collect();
    let simulator = children.iter().find(|c| c.plan.is(NodeKind::DemSimulator)).map(|c| c.member);
    let subscriptions = RunSubscriptions::new(&mut bus, simulator).map_err(Failure::failed)?;
    let (components, logs) = (Vec::new(), directory.join("logs"));
    let mut this = OneProcess { hub, bus, subscriptions, signals, followed, children, components, logs };
    this.followed.take(Event::SimulatorJoined);
    let exit = match this.build(run)? {
        None => this.attend()?,
        Some(exit) => exit,
    };
    let exit = this.end(exit)?;
    let (reasons, received) = this.followed.received();
    Ok(Supervised { exit, reasons, children: this.children, wall: begin.elapsed(), received })
}

impl OneProcess {
    /// Makes every node; the exit of the run if one of them fails.
    fn build(&mut self, run: RunId) -> Result<Option<Exit>, Failure> {
        for n in 0..self.children.len() {
            let (child, logs) = (&mut self.children[n], &self.logs);
            let plan = &child.plan;
            let Some((node, names, parameters)) = plan.parsed().map_err(Failure::usage)? else { continue };
            let (ros, _) = RosArgs::parse(&plan.arguments[2..]).map_err(Failure::usage)?;
            let name = names.fully_qualified();
            let logger = Logger::of_node(&name, &ros, open_log(logs, &plan.name).map_err(Failure::failed)?);
            let bus = self.hub.bus_as(names, Identity::member_of(run, child.member));
            let slot = ResultSlot::default();
            child.last_pid = std::process::id();
            match Component::new(bus, name, logger, |bus| node.build(bus, &parameters, &slot)) {
                Ok(component) => self.components.push(component),
                Err(error) => {
                    child.code = Some(i32::from(error.exit.code()));
                    return Ok(Some(self.ended(n, error.exit)));
                }
            }
        }
        Ok(None)
    }

    /// Steps the nodes until the run is complete, a node has ended, or the user interrupts.
    fn attend(&mut self) -> Result<Exit, Failure> {
        let mut beginning = TimeLimit::new(BEGINS_WITHIN);
        let mut next_look = self.hub.now();
        loop {
            step_all(&self.hub, &mut self.components);
            if self.signals.requested() {
                self.followed.progress.say("interrupted: ending every node and finishing the recording");
                return Ok(Exit::Interrupted);
            }
            if self.bus.has_data() {
                self.receive()?;
                if let Some(exit) = self.followed.verdict() {
                    return Ok(exit);
                }
            }
            let ended = self.components.iter().enumerate().find_map(|(n, c)| Some((n, c.exit()?)));
            if let Some((n, exit)) = ended {
                return Ok(self.ended(n, exit));
            }
            if self.hub.now() < next_look {
                continue;
            }
            next_look = self.hub.now() + POLL_PERIOD;
            self.followed.progress.draw();
            if !self.followed.begun && beginning.is_over(false) {
                beginning = TimeLimit::new(BEGINS_WITHIN);
                self.followed.say_what_is_waited_for();
            }
        }
    }

    fn receive(&mut self) -> Result<(), Failure> {
        let Self { bus, subscriptions, followed, .. } = self;
        subscriptions.receive(bus, |event| followed.take(event)).map_err(Failure::failed)
    }

    /// The exit of the run after the end of a node by itself.
    fn ended(&mut self, n: usize, exit: Exit) -> Exit {
        let (name, node) = (self.children[n].plan.name.clone(), self.children[n].plan.node);
        let why = self.followed.failed.clone().filter(|_| node == Some(NodeKind::DemSimulator));
        let why = why.unwrap_or_else(|| "the run ends".to_owned());
        self.followed.complain(format!("{name} ended with exit code {}: {why}", exit.code()));
        self.children[n].quote_log(&self.logs);
        match (node, exit) {
            (_, Exit::Usage) => Exit::Usage,
            (Some(NodeKind::Recorder), _) => Exit::DataLoss,
            (Some(NodeKind::DemSimulator), Exit::PhysicsInvalid) => Exit::PhysicsInvalid,
            _ => Exit::Failure,
        }
    }

    /// Ends every node, the recorder last; the exit of the run after that.
    fn end(&mut self, mut exit: Exit) -> Result<Exit, Failure> {
        self.followed.progress.wait_for("ending the nodes");
        let is_recorder = |child: &Child| child.plan.is(NodeKind::Recorder);
        for last in [false, true] {
            let of_turn = self.children.iter_mut().zip(&mut self.components);
            for (child, component) in of_turn.filter(|(child, _)| is_recorder(child) == last) {
                child.code = Some(i32::from(component.end().code()));
            }
            self.receive()?;
        }
        let code = |node| self.children.iter().find(|c| c.plan.is(node)).and_then(|c| c.code);
        let of = |node| code(node).and_then(Exit::from_code).unwrap_or(Exit::Failure);
        let (recorder, simulator) = (of(NodeKind::Recorder), of(NodeKind::DemSimulator));
        if exit == Exit::Done && simulator != Exit::Done {
            self.followed.simulator_failed();
            exit = simulator;
        }
        if recorder != Exit::Done && exit != Exit::Usage {
            self.followed.blame(NodeKind::Recorder, recorder.code());
            exit = worse(exit, Exit::DataLoss);
        }
        Ok(exit)
    }
}
