//! One round: its processes.

use clap::ValueEnum;
use grainlab_console::{Failure, print};
use grainlab_node_kit::{Exit, FreeDomain, Network, bus_in, pingpong};
use grainlab_recorder::tallies::losses;
use grainlab_recordings::Recording;
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
    fn start(domain: &FreeDomain, arguments: &[&str]) -> Result<Self, Failure> {
        let failed = |e: std::io::Error| Failure::failed(format!("{}: {e}", arguments.join(" ")));
        let words = grainlab_console::program().map_err(failed)?;
        let mut command = Command::new(&words[0]);
        command.args(&words[1..]).args(arguments).env("ROS_DOMAIN_ID", domain.id.to_string());
        Ok(Self(command.stdin(Stdio::null()).stdout(Stdio::piped()).spawn().map_err(failed)?))
    }

    fn role(domain: &FreeDomain, role: &str, exchanges: u64) -> Result<Self, Failure> {
        let exchanges = exchanges.to_string();
        Self::start(domain, &["bench", "lockstep", "--role", role, "--exchanges", &exchanges])
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
    let directory = TemporaryDirectory::new()?;
    let run = directory.0.join("run");
    let path = run.to_string_lossy().into_owned();
    let quiet = ["--", "--ros-args", "--log-level", "error"];
    let record = ["bag", "record", "--topics", "stress", "strain_rate", "-o", &path];
    let recorder = Process::start(&domain, &[&record[..], &quiet[..]].concat())?;
    let _pong = Process::role(&domain, "pong", exchanges)?;
    std::thread::sleep(START);
    let micros = parse(&Process::role(&domain, "ping", exchanges)?.output()?)?;
    recorder.interrupt();
    recorder.output()?;
    let tallies = Recording::open(&run).map_err(Failure::failed)?.ledger();
    // Messages before the recorder was found belong to the warm-up.
    let (_, lost) = losses(&tallies.unwrap_or_default());
    Ok(Recorded { micros, lost })
}

/// Two processes without a recorder, in a separate domain.
pub(super) fn unrecorded(exchanges: u64) -> Result<Vec<f64>, Failure> {
    let domain = FreeDomain::take()?;
    let _pong = Process::role(&domain, "pong", exchanges)?;
    std::thread::sleep(START);
    parse(&Process::role(&domain, "ping", exchanges)?.output()?)
}

fn parse(text: &str) -> Result<Vec<f64>, Failure> {
    serde_json::from_str(text)
        .map_err(|e| Failure::failed(format!("a process of the measurement printed no times: {e}")))
}

/// Runs one role.
pub(super) fn role(role: Role, exchanges: u64) -> Result<Exit, Failure> {
    let network = Network::from_env().map_err(Failure::usage)?;
    let failed = Failure::failed;
    let micros = match role {
        Role::Ping => pingpong::bus_ping(&mut bus_in(network.domain, "ping")?, exchanges).map_err(failed)?,
        Role::Pong => {
            pingpong::bus_pong(&mut bus_in(network.domain, "pong")?).map_err(failed)?;
            return Ok(Exit::Done);
        }
    };
    if (micros.len() as u64) < exchanges {
        let count = micros.len();
        return Err(Failure::failed(format!("the partner answered {count} of {exchanges} requests")));
    }
    print(&serde_json::to_string(&micros).map_err(|e| Failure::failed(e.to_string()))?)?;
    Ok(Exit::Done)
}

/// Removed with its content at the end.
struct TemporaryDirectory(PathBuf);

impl TemporaryDirectory {
    fn new() -> Result<Self, Failure> {
        let path = std::env::temp_dir().join(format!("grainlab-bench-{}", std::process::id()));
        std::fs::create_dir_all(&path).map_err(Failure::at(&path))?;
        Ok(Self(path))
    }
}

impl Drop for TemporaryDirectory {
    fn drop(&mut self) {
        // A folder that remains among temporary files does no harm.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
