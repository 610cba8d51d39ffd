//! Log lines on `/rosout` over DDS. The only test in its process, which has one logger.

use grainlab_msgs::rcl_interfaces::Log;
use grainlab_msgs::topics;
use grainlab_node_kit::{
    Bus, DdsBus, Demand, Exit, FreeDomain, Logger, Names, Network, Next, Node, NodeError, RosArgs,
    Statistics, Subscription, drive,
};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::{Duration, Instant};

/// Far above the time for discovery on an idle machine (0.2 s), so that the test passes on a loaded one.
const TIME_LIMIT: Duration = Duration::from_secs(20);

const THREADS: usize = 4;
const LINES: usize = 200;

/// A node whose threads log in its first step, and which ends when another process has received every line.
struct Busy {
    received: Receiver<()>,
    logged: bool,
}

impl Node for Busy {
    fn step(&mut self, _: &mut dyn Bus) -> Result<Next, NodeError> {
        let threads = if std::mem::replace(&mut self.logged, true) { 0 } else { THREADS };
        std::thread::scope(|scope| {
            for thread in 0..threads {
                scope.spawn(move || (0..LINES).for_each(|n| log::info!("{thread} {n}")));
            }
        });
        Ok(match self.received.try_recv() {
            Ok(()) => Next::Finished(Exit::Done),
            Err(TryRecvError::Empty) => Next::Wait(Duration::from_millis(20)),
            Err(TryRecvError::Disconnected) => Next::Finished(Exit::Failure),
        })
    }
}

/// Takes every line until the last one of the node.
fn observe(network: Network, received: &Sender<()>) -> Vec<Log> {
    let mut bus = DdsBus::open(network, Names::new("observer").unwrap()).unwrap();
    let rosout = Subscription::<Log>::subscribe(&mut bus, &topics::ROSOUT, Demand::reliable(1000)).unwrap();
    let (start, mut lines) = (Instant::now(), Vec::<Log>::new());
    while lines.last().is_none_or(|line| !line.msg.starts_with("leaving")) {
        assert!(start.elapsed() < TIME_LIMIT, "{} lines within {TIME_LIMIT:?}", lines.len());
        bus.wait(Duration::from_millis(20));
        while let Some((line, _)) = rosout.take_valid(&mut bus).unwrap() {
            lines.push(line);
            if lines.len() == THREADS * LINES {
                received.send(()).unwrap();
            }
        }
    }
    lines
}

#[test]
fn lines_of_all_threads_arrive_and_their_stamps_never_step_back() {
    let claimed = FreeDomain::take().expect("a free DDS domain");
    let network = claimed.network();
    let logger = Logger::install("/busy", &RosArgs { stderr: false, ..RosArgs::default() });
    let (sender, received) = channel();
    let observer = std::thread::spawn(move || observe(network, &sender));
    let mut bus = DdsBus::open(network, Names::new("busy").unwrap()).unwrap();
    let exit =
        drive(&mut Busy { received, logged: false }, &mut bus, "/busy", Some(logger), &|| false).unwrap();
    assert_eq!(exit, Exit::Done, "the lines arrived");

    let lines = observer.join().unwrap();
    assert_eq!(lines.len(), THREADS * LINES + 1, "each once, and the last one");
    let stamps: Vec<(i32, u32)> = lines.iter().map(|l| (l.stamp.sec, l.stamp.nanosec)).collect();
    assert!(stamps.is_sorted());
    let count = bus.published().iter().find(|p| p.topic == "/rosout").map(|p| p.count);
    assert_eq!(count, Some(lines.len() as u64));
}
