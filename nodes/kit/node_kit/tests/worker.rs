//! A job on a worker thread: the node keeps its heartbeat. One test over DDS: the watchdog counts the DDS
//! threads of the whole process.

use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::msg::RunState;
use grainlab_msgs::topics;
use grainlab_node_kit::{
    Bus, DdsBus, Demand, Exit, FreeDomain, Health, Hub, Names, Next, Node, NodeError, Publisher, Report,
    Subscription, Worker, drive,
};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

const TIME_LIMIT: Duration = Duration::from_secs(60);

/// Gives its worker one job in its first step, publishes the result, and ends.
struct OneJob {
    worker: Worker<u64, u64>,
    publisher: Publisher<RunState>,
    given: bool,
}

impl OneJob {
    fn new(bus: &mut dyn Bus, work: impl FnMut(u64) -> u64 + Send + 'static) -> Self {
        let worker = Worker::new(bus, "job", work).unwrap();
        Self { worker, publisher: Publisher::advertise(bus, &topics::RUN_STATE).unwrap(), given: false }
    }
}

impl Node for OneJob {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        if !std::mem::replace(&mut self.given, true) {
            self.worker.give(20);
        }
        let Some(step) = self.worker.result() else { return Ok(Next::Wait(Duration::from_secs(3600))) };
        self.publisher.publish(bus, &RunState { step, ..RunState::default() })?;
        Ok(Next::Finished(Exit::Done))
    }

    fn health(&self) -> Health {
        Health::ok(if self.worker.is_busy() { "busy" } else { "idle" })
    }
}

/// Runs [`OneJob`] over DDS with a job that ends when `gate` opens or closes.
fn run(claimed: &FreeDomain, gate: Receiver<()>) -> std::thread::JoinHandle<Exit> {
    let network = claimed.network();
    std::thread::spawn(move || {
        let mut bus = DdsBus::open(network, Names::new("worker").unwrap()).unwrap();
        let mut node = OneJob::new(&mut bus, move |job| {
            let _ = gate.recv();
            job + 1
        });
        drive(&mut node, &mut bus, "/worker", None, &|| false).unwrap()
    })
}

#[test]
fn a_node_keeps_its_heartbeat_while_its_worker_works_and_is_woken_when_it_is_done() {
    let claimed = FreeDomain::take().expect("a free DDS domain");
    let mut bus = DdsBus::open(claimed.network(), Names::new("observer").unwrap()).unwrap();
    let beats: Subscription<DiagnosticArray> =
        Subscription::subscribe(&mut bus, &topics::DIAGNOSTICS, Demand::reliable(100)).unwrap();
    let states: Subscription<RunState> =
        Subscription::subscribe(&mut bus, &topics::RUN_STATE, Demand::reliable(10)).unwrap();
    let (open, gate) = channel();
    let node = run(&claimed, gate);
    let begun = Instant::now();
    let mut busy = 0;
    while busy < 3 {
        assert!(begun.elapsed() < TIME_LIMIT, "three heartbeats");
        bus.wait(Duration::from_millis(50));
        while let Some((message, _)) = beats.take_valid(&mut bus).unwrap() {
            busy += Report::from_message(&message).iter().filter(|r| r.health.message == "busy").count();
        }
    }
    assert!(states.take_valid(&mut bus).unwrap().is_none(), "the job is still under way");
    open.send(()).unwrap();
    let state = loop {
        assert!(begun.elapsed() < TIME_LIMIT, "the result");
        if let Some((state, _)) = states.take_valid(&mut bus).unwrap() {
            break state;
        }
        bus.wait(Duration::from_millis(50));
    };
    assert_eq!(state.step, 21);
    assert_eq!(node.join().unwrap(), Exit::Done);
}

#[test]
fn on_the_bus_in_memory_a_job_is_done_as_soon_as_it_is_given() {
    let hub = Hub::new(1);
    let bus = hub.bus(Names::new("worker").unwrap());
    let mut total = 0;
    let mut worker = Worker::new(&bus, "sum", move |job: u64| {
        total += job;
        total
    })
    .unwrap();
    for (job, sum) in [(2, 2), (5, 7)] {
        assert!(!worker.is_busy() && worker.result().is_none());
        worker.give(job);
        assert!(worker.is_busy());
        assert_eq!(worker.result(), Some(sum));
    }
}
