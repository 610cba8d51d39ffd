//! The run loop, on the bus in memory and in virtual time.

use crate::bus_of;
use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::msg::RunState;
use grainlab_msgs::topics;
use grainlab_node_kit::{
    Bus, Demand, Exit, Health, Hub, Level, MemoryBus, Names, Next, Node, NodeError, NodeSpec, ParameterSpec,
    Publisher, Range, Report, RosArgs, Scope, Subscription, drive, run_node,
};
use std::time::Duration;

const TICK: Duration = Duration::from_millis(100);

/// Publishes each tick until it is stopped or fails.
struct Ticker {
    publisher: Publisher<RunState>,
    ticks: u64,
    then: fn(u64) -> Result<Next, NodeError>,
}

impl Ticker {
    fn new(bus: &mut MemoryBus, then: fn(u64) -> Result<Next, NodeError>) -> Self {
        let publisher = Publisher::advertise(bus, &topics::RUN_STATE).unwrap();
        Self { publisher, ticks: 0, then }
    }
}

impl Node for Ticker {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        self.ticks += 1;
        self.publisher.publish(bus, &RunState { step: self.ticks, ..RunState::default() })?;
        (self.then)(self.ticks)
    }

    fn health(&self) -> Health {
        Health::warn("ticking").with("ticks", self.ticks)
    }

    fn on_shutdown(&mut self, _: &mut dyn Bus) -> Result<Exit, NodeError> {
        Ok(Exit::Interrupted)
    }
}

struct Heard {
    reports: Vec<(Report, i64)>,
    states: i64,
}

/// Runs a ticker to its end with a passive observer.
fn run(then: fn(u64) -> Result<Next, NodeError>, interrupt: bool) -> (Exit, Ticker, Heard) {
    let hub = Hub::new(5);
    let mut bus = bus_of(&hub, "ticker");
    let mut observer = hub.bus(Names::new("observer").unwrap());
    let diagnostics = Subscription::<DiagnosticArray>::subscribe(
        &mut observer,
        &topics::DIAGNOSTICS,
        Demand::reliable(1000),
    )
    .unwrap();
    let mut lab = bus_of(&hub, "observer");
    let states =
        Subscription::<RunState>::subscribe(&mut lab, &topics::RUN_STATE, Demand::reliable(1000)).unwrap();

    let mut node = Ticker::new(&mut bus, then);
    if interrupt {
        bus.interrupt();
    }
    let exit = drive(&mut node, &mut bus, "/lab/ticker", None, &|| false).unwrap();
    let mut heard = Heard { reports: Vec::new(), states: 0 };
    while let Some((message, info)) = diagnostics.take_valid(&mut observer).unwrap() {
        heard.reports.extend(Report::from_message(&message).into_iter().map(|r| (r, info.sequence)));
    }
    while let Some((_, info)) = states.take_valid(&mut lab).unwrap() {
        heard.states = info.sequence;
    }
    (exit, node, heard)
}

fn after(ticks: u64, limit: u64, end: Result<Next, NodeError>) -> Result<Next, NodeError> {
    if ticks < limit { Ok(Next::Wait(TICK)) } else { end }
}

#[test]
fn health_is_reported_each_second_and_the_last_report_counts_itself() {
    // Ticks at 0.0, 0.1, … 3.4 s: heartbeats after 1, 2 and 3 s, then the last report.
    let (exit, node, heard) = run(|ticks| after(ticks, 35, Ok(Next::Finished(Exit::DataLoss))), false);
    assert_eq!((exit, node.ticks), (Exit::DataLoss, 35));
    assert_eq!(heard.reports.len(), 4);
    for (report, _) in &heard.reports[..3] {
        assert!(!report.is_final());
        assert_eq!((report.health.level, report.health.message.as_str()), (Level::Warn, "ticking"));
    }
    let (last, sequence) = &heard.reports[3];
    assert_eq!(last.exit, Some(Exit::DataLoss));
    assert_eq!(last.health.values, [("ticks".into(), "35".into())]);
    let count = |topic: &str| last.published.iter().find(|p| p.topic == topic).map(|p| p.count as i64);
    assert_eq!(count("/diagnostics"), Some(*sequence));
    assert_eq!(count("/lab/run_state"), Some(heard.states));
    assert_eq!(heard.states, 35);
}

#[test]
fn an_error_ends_the_node_with_its_own_exit_code() {
    let failing = |ticks| after(ticks, 3, Err(NodeError::new(Exit::PhysicsInvalid, "grain 7 is nowhere")));
    let (exit, _, heard) = run(failing, false);
    assert_eq!(exit, Exit::PhysicsInvalid);
    assert_eq!(heard.reports.last().and_then(|(r, _)| r.exit), Some(Exit::PhysicsInvalid));
}

#[test]
fn an_interrupted_node_reports_how_complete_it_is() {
    let (exit, node, _) = run(|_| Ok(Next::Wait(TICK)), true);
    assert_eq!((exit, node.ticks), (Exit::Interrupted, 1));
}

#[test]
fn a_node_that_never_waits_is_stopped_between_two_steps() {
    let hub = Hub::new(1);
    let mut bus = bus_of(&hub, "ticker");
    let mut node = Ticker::new(&mut bus, |_| Ok(Next::Again));
    let asked = std::cell::Cell::new(0);
    let stop = || {
        asked.set(asked.get() + 1);
        asked.get() > 10
    };
    assert_eq!(drive(&mut node, &mut bus, "/lab/ticker", None, &stop).unwrap(), Exit::Interrupted);
    assert_eq!(node.ticks, 10);
}

#[test]
fn wrong_arguments_end_before_anything_starts() {
    let spec = NodeSpec {
        name: "ticker",
        summary: "ticks",
        scope: Scope::Everyone,
        parameters: vec![ParameterSpec::new("dt", 1.0, "time step, s").within(Range::Positive)],
    };
    for wrong in
        ["-p mu:=1", "-p dt:=-1", "-p other:dt:=1", "-r __ns:=lab", "-r __node:=a-b", "--params-file /none"]
    {
        let line: Vec<String> = format!("--ros-args {wrong}").split(' ').map(Into::into).collect();
        let (args, _) = RosArgs::parse(&line).unwrap();
        let args = RosArgs { stderr: false, rosout: false, ..args };
        let exit =
            run_node(&spec, &args, |_, _| unreachable!("{wrong} must be refused before the bus opens"));
        assert_eq!(exit, Exit::Usage, "{wrong}");
    }
}
