//! Processes that the tests in `tests/process` start, by the name of their role.

use grainlab_buskit::pingpong::bus_pong;
use grainlab_msgs::msg::{RunState, StrainRate, Stress};
use grainlab_msgs::topics;
use grainlab_node_kit::{
    Bus, DdsBus, Demand, Exit, Health, Names, Network, Next, Node, NodeError, NodeSpec, Publisher, RosArgs,
    Scope, Subscription, SubscriptionId, run_node,
};
use std::time::Duration;

fn main() {
    let role = std::env::args().nth(1).expect("the name of a role");
    match role.as_str() {
        "talker" => talk("talker", Exit::Done, Duration::ZERO),
        "incomplete_talker" => talk("incomplete_talker", Exit::Interrupted, Duration::ZERO),
        "slow_talker" => talk("slow_talker", Exit::Done, Duration::from_secs(60)),
        "talker_without_dds_thread" => talker_without_dds_thread(),
        "panicking_node" => panicking_node(),
        "our_listener" => our_listener(),
        "answerer" => bus_pong(&mut bus("answerer")).unwrap(),
        "victim" => victim(),
        other => panic!("there is no role {other}"),
    }
}

/// Publishes a state periodically.
struct Talker {
    publisher: Publisher<RunState>,
    step: u64,
    at_end: Exit,
    /// Duration of the final step.
    dawdle: Duration,
}

impl Node for Talker {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        self.step += 1;
        self.publisher.publish(bus, &RunState { step: self.step, ..RunState::default() })?;
        Ok(Next::Wait(Duration::from_millis(50)))
    }

    fn health(&self) -> Health {
        Health::ok("talking").with("step", self.step)
    }

    fn on_shutdown(&mut self, bus: &mut dyn Bus) -> Result<Exit, NodeError> {
        self.publisher.publish(bus, &RunState { step: 0, ..RunState::default() })?;
        std::thread::sleep(self.dawdle);
        Ok(self.at_end)
    }
}

fn talk(name: &'static str, at_end: Exit, dawdle: Duration) -> ! {
    let spec = NodeSpec { name, summary: "talks", scope: Scope::Everyone, parameters: Vec::new() };
    let exit = run_node(&spec, &RosArgs::default(), |bus, _| {
        let publisher = Publisher::advertise(bus, &topics::RUN_STATE)?;
        Ok(Box::new(Talker { publisher, step: 0, at_end, dawdle }))
    });
    std::process::exit(i32::from(exit.code()))
}

fn talker_without_dds_thread() {
    std::thread::spawn(|| {
        std::thread::sleep(Duration::from_secs(2));
        end_dds_thread();
    });
    talk("deaf_talker", Exit::Done, Duration::ZERO)
}

/// Ends only the event loop's thread, as a bug in it would: its next signal handler leaves through
/// `SYS_exit`.
fn end_dds_thread() {
    extern "C" fn leave(_: i32) {
        // SAFETY: ends the calling thread without unwinding; that is the fault to detect.
        unsafe { libc::syscall(libc::SYS_exit, 0) };
    }
    for task in std::fs::read_dir("/proc/self/task").unwrap().flatten() {
        let name = std::fs::read_to_string(task.path().join("comm")).unwrap();
        if name.starts_with("RustDDS Partici") {
            let thread: i32 = task.file_name().to_str().unwrap().parse().unwrap();
            // SAFETY: the handler is async-signal-safe, and the thread belongs to this process.
            unsafe {
                libc::signal(libc::SIGUSR1, leave as *const () as libc::sighandler_t);
                libc::syscall(libc::SYS_tgkill, std::process::id(), thread, libc::SIGUSR1);
            }
        }
    }
}

fn panicking_node() {
    struct Panics;
    impl Node for Panics {
        fn step(&mut self, _: &mut dyn Bus) -> Result<Next, NodeError> {
            panic!("the bug")
        }
    }
    let spec =
        NodeSpec { name: "panicking", summary: "panics", scope: Scope::Everyone, parameters: Vec::new() };
    let exit = run_node(&spec, &RosArgs::default(), |_, _| Ok(Box::new(Panics)));
    std::process::exit(i32::from(exit.code()))
}

fn bus(name: &str) -> DdsBus {
    DdsBus::open(Network::from_env().unwrap(), Names::new(name).unwrap()).unwrap()
}

/// Reads the exchange reliably, as the recorder does, until nothing arrives for some seconds after the first sample.
fn our_listener() {
    let mut bus = bus("listener");
    let demand = Demand::reliable(20_000);
    let both = [&topics::STRESS, &topics::STRAIN_RATE].map(|topic| bus.subscribe(topic, demand).unwrap());
    let (mut last, mut received, mut missing) = ([None; 2], 0_u64, 0);
    let (mut patience, mut heard) = (Duration::from_secs(30), bus.now());
    while bus.now() - heard <= patience {
        for (subscription, last) in both.iter().zip(&mut last) {
            while let Some(sample) = bus.take(*subscription).unwrap() {
                let sequence = sample.info.sequence;
                missing += last.map_or(0, |last: i64| (sequence - last - 1).max(0));
                *last = Some(sequence);
                received += 1;
                (patience, heard) = (Duration::from_secs(5), bus.now());
            }
        }
        bus.wait(Duration::from_secs(1));
    }
    println!("listener: received {received} missing {missing}");
}

/// Subscribes and advertises every topic of the contract, and answers each stress.
struct Victim {
    stress: Subscription<Stress>,
    rate: Publisher<StrainRate>,
    others: Vec<SubscriptionId>,
}

impl Node for Victim {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        while let Some((stress, _)) = self.stress.take_valid(bus)? {
            let rate = StrainRate { sequence: stress.sequence, ..StrainRate::default() };
            // A reader that never acknowledges may be forged; the request is repeated.
            if let Err(error) = self.rate.publish(bus, &rate) {
                log::warn!("{error}");
            }
        }
        for other in &self.others {
            while bus.take(*other)?.is_some() {}
        }
        Ok(Next::Wait(Duration::from_millis(500)))
    }

    fn health(&self) -> Health {
        Health::ok("answering")
    }
}

fn victim() {
    let spec =
        NodeSpec { name: "victim", summary: "answers", scope: Scope::Everyone, parameters: Vec::new() };
    let exit = run_node(&spec, &RosArgs::default(), |bus, _| {
        let rate = Publisher::advertise(bus, &topics::STRAIN_RATE)?;
        let stress = Subscription::subscribe(bus, &topics::STRESS, Demand::best_effort(64))?;
        let mut others = Vec::new();
        for topic in topics::TOPICS {
            if ![topics::STRESS.name, topics::STRAIN_RATE.name].contains(&topic.name) {
                others.push(bus.subscribe(topic, Demand::reliable(100))?);
            }
            if topic.writer == topics::STRESS.writer {
                bus.advertise(topic)?;
            }
        }
        Ok(Box::new(Victim { stress, rate, others }))
    });
    std::process::exit(i32::from(exit.code()))
}
