//! One round: its processes.

use clap::ValueEnum;
use grainlab_buskit::pingpong;
use grainlab_console::{Failure, print};
use grainlab_node_kit::{Exit, FreeDomain, Network, NodeSpec, RosArgs, Scope, bus_in, run_node};
use grainlab_recorder::tallies::losses;
use grainlab_recorder::{Recorder, ResultSlot, Settings, contract_topics};
use grainlab_recordings::{Recording, WriterOptions};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Time for a process to start before the next one depends on it.
const START: Duration = Duration::from_millis(1000);

/// The role of one process of the measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Role {
    /// Sends requests over the bus of grainlab.
    Ping,
    /// Answers over the bus of grainlab.
    Pong,
    /// Records both.
    Recorder,
}

/// Results of a round with a recorder.
pub(super) struct Recorded {
    /// Duration of each exchange.
    pub(super) micros: Vec<f64>,
    /// Messages that the recorder lost.
    pub(super) lost: u64,
}

/// A child process that is ended with its round.
struct Process(Child);

impl Process {
    /// Starts this program in a role, with further arguments.
    fn start(domain: &FreeDomain, role: &str, arguments: &[&str]) -> Result<Self, Failure> {
        let failed = |e: std::io::Error| Failure::failed(format!("{role}: {e}"));
        let mut command = Command::new(std::env::current_exe().map_err(failed)?);
        command
            .args(["lockstep", "--role", role])
            .args(arguments)
            .env("ROS_DOMAIN_ID", domain.id.to_string());
        Ok(Self(command.stdin(Stdio::null()).stdout(Stdio::piped()).spawn().map_err(failed)?))
    }

    /// Waits for the end; returns its standard output.
    fn output(mut self) -> Result<String, Failure> {
        let failed = |e: std::io::Error| Failure::failed(format!("a process of the measurement: {e}"));
        let text = self.0.stdout.take().map(std::io::read_to_string).transpose().map_err(failed)?;
        let status = self.0.wait().map_err(failed)?;
        match status.code() {
            Some(0 | 3) => Ok(text.unwrap_or_default()),
            _ => Err(Failure::failed(format!("a process of the measurement failed: {status}"))),
        }
    }

    fn interrupt(&self) {
        // SAFETY: kill takes two integers. The child was not waited for, so that its id has not been reused.
        unsafe { libc::kill(self.0.id() as i32, libc::SIGINT) };
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // Both fail only if the process has ended.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Two processes and a recorder, in a separate domain.
pub(super) fn recorded(exchanges: u64) -> Result<Recorded, Failure> {
    let domain = FreeDomain::take()?;
    let folder = tempfile::tempdir().map_err(Failure::failed)?;
    let run = folder.path().join("run");
    let recorder = Process::start(&domain, "recorder", &["--output", &run.to_string_lossy()])?;
    let micros = answered(&domain, exchanges)?;
    recorder.interrupt();
    recorder.output()?;
    let tallies = Recording::open(&run).map_err(Failure::failed)?.ledger();
    // Messages before the recorder was found belong to the warm-up.
    let (_, lost) = losses(&tallies.unwrap_or_default());
    Ok(Recorded { micros, lost })
}

/// Two processes without a recorder, in a separate domain.
pub(super) fn unrecorded(exchanges: u64) -> Result<Vec<f64>, Failure> {
    answered(&FreeDomain::take()?, exchanges)
}

/// Duration of each exchange of two processes.
fn answered(domain: &FreeDomain, exchanges: u64) -> Result<Vec<f64>, Failure> {
    let _pong = Process::start(domain, "pong", &[])?;
    std::thread::sleep(START);
    parse(&Process::start(domain, "ping", &["--exchanges", &exchanges.to_string()])?.output()?)
}

fn parse(text: &str) -> Result<Vec<f64>, Failure> {
    serde_json::from_str(text)
        .map_err(|e| Failure::failed(format!("a process of the measurement printed no times: {e}")))
}

/// Runs one role.
pub(super) fn role(role: Role, exchanges: u64, output: Option<PathBuf>) -> Result<Exit, Failure> {
    let domain = Network::from_env().map_err(Failure::usage)?.domain;
    let micros = match role {
        Role::Ping => pingpong::bus_ping(&mut bus_in(domain, "ping")?, exchanges).map_err(Failure::failed)?,
        Role::Pong => {
            pingpong::bus_pong(&mut bus_in(domain, "pong")?).map_err(Failure::failed)?;
            return Ok(Exit::Done);
        }
        Role::Recorder => return record(output),
    };
    if (micros.len() as u64) < exchanges {
        let count = micros.len();
        return Err(Failure::failed(format!("the partner answered {count} of {exchanges} requests")));
    }
    print(&serde_json::to_string(&micros).map_err(|e| Failure::failed(e.to_string()))?)?;
    Ok(Exit::Done)
}

/// Records the exchanges until an interrupt.
fn record(output: Option<PathBuf>) -> Result<Exit, Failure> {
    let topics = contract_topics(&["stress", "strain_rate"].map(str::to_owned))?;
    let settings = Settings {
        output,
        topics,
        others: None,
        scene: None,
        whole_run: false,
        append: false,
        writer: WriterOptions::default(),
    };
    let spec = NodeSpec {
        name: "recorder",
        summary: "records the exchanges",
        scope: Scope::Everyone,
        parameters: Vec::new(),
    };
    let words = ["--ros-args", "--log-level", "error"].map(str::to_owned);
    let (ros, _) = RosArgs::parse(&words).map_err(Failure::usage)?;
    let recorded = ResultSlot::default();
    Ok(run_node(&spec, &ros, |bus, _| Ok(Box::new(Recorder::new(bus, &settings, recorded.clone())?))))
}
