//! Runs a node: the only file that waits.

use crate::args::RosArgs;
use crate::bus::{Bus, Wake};
use crate::dds::{DdsBus, Network};
use crate::housekeeping::{DriveError, Housekeeping};
use crate::identity::{Identity, Scope};
use crate::logging::Logger;
use crate::names::Names;
use crate::node::{Next, Node, NodeError};
use crate::parameters::{ParameterSpec, Parameters};
use crate::services::USE_SIM_TIME;
use crate::watchdog;
use grainlab_console::Signals;
use grainlab_msgs::Exit;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::time::Duration;

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
pub fn use_sim_time() -> ParameterSpec {
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
        network.exposure().iter().for_each(|text| log::warn!("{text}"));
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
