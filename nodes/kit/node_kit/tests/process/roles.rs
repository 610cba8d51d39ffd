//! The roles of the children. Each is ignored: it runs only when a test starts it by name.

use grainlab_msgs::msg::{RunState, StrainRate, Stress};
use grainlab_msgs::topics;
use grainlab_node_kit::pingpong::{bus_listen, bus_pong};
use grainlab_node_kit::{
    Bus, DdsBus, Demand, Exit, Health, Names, Network, Next, Node, NodeError, NodeSpec, Publisher, RosArgs,
    Scope, Subscription, SubscriptionId, run_node,
};
use std::time::Duration;

/// Whether this process is a child; `--ignored` without a name must not start the roles.
fn is_child() -> bool {
    std::env::var_os(super::CHILD).is_some()
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

#[test]
#[ignore = "a role, started by other tests"]
fn talker() {
    if !is_child() {
        return;
    }
    talk("talker", Exit::Done, Duration::ZERO)
}

#[test]
#[ignore = "a role, started by other tests"]
fn incomplete_talker() {
    if !is_child() {
        return;
    }
    talk("incomplete_talker", Exit::Interrupted, Duration::ZERO)
}

#[test]
#[ignore = "a role, started by other tests"]
fn slow_talker() {
    if !is_child() {
        return;
    }
    talk("slow_talker", Exit::Done, Duration::from_secs(60))
}

#[test]
#[ignore = "a role, started by other tests"]
fn talker_without_dds_thread() {
    if !is_child() {
        return;
    }
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

#[test]
#[ignore = "a role, started by other tests"]
fn panicking_node() {
    if !is_child() {
        return;
    }
    struct Panics;
    impl Node for Panics {
        fn step(&mut self, _: &mut dyn Bus) -> Result<Next, NodeError> {
            panic!("the bug")
        }
        fn health(&self) -> Health {
            Health::default()
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

#[test]
#[ignore = "a role, started by other tests"]
fn our_listener() {
    if !is_child() {
        return;
    }
    let (received, missing) = bus_listen(&mut bus("listener")).unwrap();
    println!("listener: received {received} missing {missing}");
}

#[test]
#[ignore = "a role, started by other tests"]
fn answerer() {
    if !is_child() {
        return;
    }
    bus_pong(&mut bus("answerer")).unwrap();
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

#[test]
#[ignore = "a role, started by other tests"]
fn victim() {
    if !is_child() {
        return;
    }
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
