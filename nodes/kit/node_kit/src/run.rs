//! Runs a node: the only file that waits.

use crate::args::RosArgs;
use crate::bus::{Bus, Wake};
use crate::bus_error::{BusError, tolerate_full};
use crate::dds::{DdsBus, Network};
use crate::identity::{Identity, Scope};
use crate::logging::Logger;
use crate::names::Names;
use crate::node::{Next, Node, NodeError};
use crate::parameters::{ParameterSpec, Parameters};
use crate::rosout::Rosout;
use crate::services::USE_SIM_TIME;
use crate::typed::Publisher;
use crate::watchdog;
use grainlab_console::Signals;
use grainlab_msgs::diagnostic_msgs::DiagnosticArray;
use grainlab_msgs::{Exit, Guid, Published, Received, Report, topics};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::time::Duration;

/// Time between two heartbeats, and from the start to the first: `/diagnostics` keeps nothing for late joiners, and a
/// recorder that is not discovered yet would miss it and count it as lost.
pub const HEARTBEAT: Duration = Duration::from_secs(1);

/// Period at which a node that never waits updates its view of the graph.
const LOOK: Duration = Duration::from_millis(100);

/// Time for which an ending process waits for its readers' acknowledgements: a recorder that was suspended has some
/// megabytes to request again. A crashed one costs this time.
const LAST_WORDS: Duration = Duration::from_secs(1);

/// Time for which it stays after that: a reader loses the samples it has not taken when the writer leaves. A busy node's
/// readers are emptied within 40 ms, on a busy host some ten milliseconds later.
const GRACE: Duration = Duration::from_millis(90);

/// Name, description and parameters of a node.
#[derive(Clone, Debug)]
pub struct NodeSpec {
    /// Default name; `__node` overrides it.
    pub name: &'static str,
    /// Description, one line.
    pub summary: &'static str,
    /// Whose samples it accepts if started by hand, without a run.
    pub scope: Scope,
    /// Parameters of the node.
    pub parameters: Vec<ParameterSpec>,
}

/// Runs one node as this process: arguments, logs, signals, DDS, the loop, and the orderly end.
///
/// `build` makes the node on the open bus, where it subscribes and advertises. The first SIGINT or SIGTERM ends the run
/// after the current step, the second ends the process at once.
pub fn run_node<F>(spec: &NodeSpec, args: &RosArgs, build: F) -> Exit
where
    F: FnOnce(&mut dyn Bus, &Parameters) -> Result<Box<dyn Node>, NodeError>,
{
    Logger::install(spec.name, args);
    watchdog::watch_dds_threads();
    // A panic of a node is a bug, but it ends like every other failure: with exit 1 and a last report.
    catch_unwind(AssertUnwindSafe(|| run_process(spec, args, build))).unwrap_or_else(|_| {
        log::error!("{} panicked (see above); this is a bug", spec.name);
        Exit::Failure
    })
}

/// The parameter that ROS 2 gives to every node.
fn use_sim_time() -> ParameterSpec {
    let meaning = "whether /diagnostics is stamped with the time of /clock; all other stamps are the simulator's anyway";
    ParameterSpec::new(USE_SIM_TIME, false, meaning).changeable()
}

fn run_process<F>(spec: &NodeSpec, args: &RosArgs, build: F) -> Exit
where
    F: FnOnce(&mut dyn Bus, &Parameters) -> Result<Box<dyn Node>, NodeError>,
{
    fn refused<T, E: std::fmt::Display>(exit: Exit, result: Result<T, E>) -> Result<T, Exit> {
        result.map_err(|error| {
            log::error!("{error}");
            exit
        })
    }
    let start = || -> Result<Exit, Exit> {
        let names = refused(Exit::Usage, Names::from_args(spec.name, args))?;
        let specs: Vec<ParameterSpec> = spec.parameters.iter().cloned().chain([use_sim_time()]).collect();
        let parameters = refused(Exit::Usage, Parameters::resolve(&specs, spec.name, &names, args))?;
        let network = refused(Exit::Usage, Network::from_env())?;
        let node_name = names.fully_qualified();
        let logger = Logger::install(&node_name, args);
        let identity = Identity::from_env(spec.scope);
        let signals = refused(Exit::Failure, Signals::of_node(identity.root))?;
        let stop = signals.flag();
        let mut bus =
            refused(Exit::Failure, DdsBus::declaring(network, names, identity, parameters.clone()))?;
        refused(Exit::Failure, bus.watch(signals))?;
        let mut node = build(&mut bus, &parameters).map_err(|error| {
            log::error!("{error}");
            error.exit
        })?;
        refused(Exit::Failure, bus.serve())?;
        let stop = move || stop.load(std::sync::atomic::Ordering::Relaxed);
        let driven = drive(node.as_mut(), &mut bus, &node_name, Some(logger), &stop);
        if let Err(DriveError::Dds(failure)) = driven {
            log::error!("{failure}");
            // Dropping the bus would wait for the failed threads.
            std::process::exit(i32::from(Exit::Failure.code()));
        }
        let exit = refused(Exit::Failure, driven)?;
        std::thread::sleep(GRACE);
        Ok(exit)
    };
    start().unwrap_or_else(|exit| exit)
}

/// Steps a node on any bus until it finishes, fails, or is stopped; reports its health once a second and its final
/// counts at the end. `stop` is called before every step, for nodes that never wait.
pub fn drive(
    node: &mut dyn Node,
    bus: &mut dyn Bus,
    node_name: &str,
    logger: Option<&'static Logger>,
    stop: &dyn Fn() -> bool,
) -> Result<Exit, DriveError> {
    let mut housekeeping = Housekeeping::new(bus, node_name, logger)?;
    let mut asked = false;
    let exit = loop {
        let until_beat = housekeeping.tend(node, bus)?;
        if asked || stop() {
            log::info!("stopping on request");
            break settle(node.on_shutdown(bus));
        }
        let stepped = catch_unwind(AssertUnwindSafe(|| node.step(bus))).unwrap_or_else(|panic| {
            // The last lines before a panic explain it.
            let _ = housekeeping.rosout.close(bus);
            resume_unwind(panic)
        });
        match stepped {
            Ok(Next::Again) if housekeeping.look_due(bus.now()) => {
                asked = bus.wait(Duration::ZERO) == Wake::Shutdown
            }
            Ok(Next::Again) => {}
            Ok(Next::Wait(time)) => asked = bus.wait(time.min(until_beat)) == Wake::Shutdown,
            Ok(Next::Finished(exit)) => break exit,
            Err(error) => break settle(Err(error)),
        }
    };
    housekeeping.leave(node, bus, exit)?;
    Ok(exit)
}

fn settle(result: Result<Exit, NodeError>) -> Exit {
    result.unwrap_or_else(|error| {
        log::error!("{error}");
        error.exit
    })
}

/// Errors of the run loop.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// The DDS threads of this process have ended or hang; the bus must not even be dropped, which would wait for them.
    #[error(transparent)]
    Dds(#[from] watchdog::DdsFailure),
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
}

/// Heartbeats, log lines and watchdog of one process.
struct Housekeeping {
    node_name: String,
    diagnostics: Publisher<DiagnosticArray>,
    diagnostics_writer: Option<Guid>,
    rosout: Rosout,
    next_beat: Duration,
    next_look: Duration,
}

impl Housekeeping {
    fn new(bus: &mut dyn Bus, node_name: &str, logger: Option<&'static Logger>) -> Result<Self, BusError> {
        let diagnostics = Publisher::advertise(bus, &topics::DIAGNOSTICS)?;
        let diagnostics_writer = bus.published().last().map(|p| p.writer);
        Ok(Self {
            node_name: node_name.into(),
            diagnostics,
            diagnostics_writer,
            rosout: Rosout::advertise(bus, logger)?,
            next_beat: bus.now() + HEARTBEAT,
            next_look: bus.now() + LOOK,
        })
    }

    /// Does the tasks that are due and returns the time until the next heartbeat.
    fn tend(&mut self, node: &mut dyn Node, bus: &mut dyn Bus) -> Result<Duration, DriveError> {
        self.rosout.tend(bus)?;
        let now = bus.now();
        if now >= self.next_beat {
            self.report(node, bus, None)?;
            watchdog::check()?;
            self.next_beat = now + HEARTBEAT;
        }
        Ok(self.next_beat.saturating_sub(now))
    }

    /// True if a node that never waits has to poll the bus, so that it follows the graph.
    fn look_due(&mut self, now: Duration) -> bool {
        let due = now >= self.next_look;
        if due {
            self.next_look = now + LOOK;
        }
        due
    }

    fn report(&self, node: &dyn Node, bus: &mut dyn Bus, exit: Option<Exit>) -> Result<(), BusError> {
        let (node, health) = (self.node_name.clone(), node.health());
        let (published, received) = (self.published(bus), received(bus));
        let report = Report { node, pid: std::process::id(), health, exit, published, received };
        let message = report.to_message(bus.node_nanos());
        tolerate_full(self.diagnostics.publish(bus, &message))
    }

    /// The statistics of writers. That of the reports includes the one that is about to be published.
    fn published(&self, bus: &dyn Bus) -> Vec<Published> {
        let mut published = bus.published();
        for writer in published.iter_mut().filter(|w| Some(w.writer) == self.diagnostics_writer) {
            writer.count += 1;
        }
        published
    }

    /// Publishes the last log lines, then the last report: nothing is published after it, so its counts are final.
    fn leave(&mut self, node: &dyn Node, bus: &mut dyn Bus, exit: Exit) -> Result<(), BusError> {
        log::info!("leaving: {exit}");
        self.rosout.close(bus)?;
        self.report(node, bus, Some(exit))?;
        bus.flush(LAST_WORDS);
        Ok(())
    }
}

/// The statistics of subscriptions, summed by topic.
fn received(bus: &dyn Bus) -> Vec<Received> {
    let mut received: Vec<Received> = Vec::new();
    for entry in bus.received() {
        match received.iter_mut().find(|r| r.topic == entry.topic) {
            Some(sum) => {
                sum.taken = sum.taken.max(entry.taken);
                sum.refused += entry.refused;
            }
            None => received.push(entry),
        }
    }
    received
}
