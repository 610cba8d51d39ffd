//! The `grainlab` binary under test, in a separate folder and DDS domain.

use crate::process::{Ended, Process, children};
use grainlab_msgs::Topic;
use grainlab_node_kit::{Bus, DdsBus, Names, Network, is_in_use};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicU16, Ordering};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Time limit of any command of a test.
pub const LIMIT: Duration = Duration::from_secs(120);

/// Waits until `holds`; the test fails with `what` after [`LIMIT`].
pub fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !holds() {
        assert!(begin.elapsed() < LIMIT, "within {LIMIT:?}: {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// The pid of the child of `launcher` with these words in its command line, once there is one.
pub fn appeared(launcher: &Process, words: &str) -> u32 {
    until(words, || children(launcher.pid(), words).len() == 1);
    children(launcher.pid(), words)[0]
}

/// A laboratory: working folder and domain.
#[derive(Debug)]
pub struct Lab {
    folder: TempDir,
    /// DDS domain that no other process on this host uses.
    pub domain: u16,
}

impl Lab {
    /// A new folder and a free domain.
    pub fn new() -> Self {
        let folder = tempfile::Builder::new().prefix("grainlab-").tempdir();
        Self { folder: folder.unwrap_or_else(|e| panic!("no temporary folder: {e}")), domain: free_domain() }
    }

    /// The working folder.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// `grainlab` with these arguments, in the folder and domain.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(grainlab());
        command
            .args(arguments)
            .current_dir(self.folder())
            .env("ROS_DOMAIN_ID", self.domain.to_string())
            .env_remove("GRAINLAB_RUN")
            .env_remove("ROS_STATIC_PEERS")
            .env_remove("ROS_LOCALHOST_ONLY")
            .env_remove("ROS_AUTOMATIC_DISCOVERY_RANGE")
            .env("NO_COLOR", "1");
        command
    }

    /// Starts `grainlab` with these arguments.
    pub fn start(&self, arguments: &[&str]) -> Process {
        Process::start(&mut self.command(arguments))
    }

    /// Runs `grainlab` with these arguments to its end.
    pub fn run(&self, arguments: &[&str]) -> Ended {
        self.start(arguments).ended(LIMIT)
    }

    /// Runs a whole scene with the launcher; returns the run's folder. Fails the test unless the exit code is 0.
    pub fn launch(&self, scene: &Path, extra: &[&str]) -> PathBuf {
        let scene = scene.to_string_lossy();
        let mut arguments = vec!["launch", "--scene", &scene];
        arguments.extend(extra);
        let ended = self.run(&arguments);
        assert_eq!(ended.code, Some(0), "launch failed\n{}\n{}", ended.stdout, ended.stderr);
        self.last_run()
    }

    /// Number of messages of `/stress` that the current run has recorded.
    pub fn recorded(&self) -> usize {
        let recorded = || {
            let runs = std::fs::read_dir(self.folder().join("recordings/runs")).ok()?;
            let run = runs.flatten().next()?.path();
            let recording = grainlab_recordings::Recording::open(&run).ok()?;
            Some(recording.messages(&grainlab_recordings::Selection::topics(["/stress"])).ok()?.count())
        };
        recorded().unwrap_or(0)
    }

    /// Waits until the current run has recorded this many messages of `/stress`.
    pub fn until_recorded(&self, messages: usize) {
        until("messages of /stress", || self.recorded() >= messages);
    }

    /// Waits until a process that was started by hand has announced a writer of `topic`.
    pub fn until_announced(&self, topic: &Topic) {
        let names = Names::new("observer").unwrap_or_else(|e| panic!("{e}"));
        let mut bus = DdsBus::open(Network::localhost(self.domain), names).unwrap_or_else(|e| panic!("{e}"));
        until(topic.name, || {
            bus.wait(Duration::from_millis(50));
            !bus.foreign_writers(topic).is_empty()
        });
    }

    /// The newest run in the folder.
    pub fn last_run(&self) -> PathBuf {
        let runs = self.folder().join("recordings/runs");
        let entries = std::fs::read_dir(&runs).unwrap_or_else(|e| panic!("{}: {e}", runs.display()));
        let newest = entries.flatten().max_by_key(|e| e.metadata().and_then(|m| m.modified()).ok());
        newest.unwrap_or_else(|| panic!("no run in {}", runs.display())).path()
    }
}

impl Default for Lab {
    fn default() -> Self {
        Self::new()
    }
}

/// The path of a built program in or above the folder of the running test.
fn built(name: &str) -> PathBuf {
    let test = std::env::current_exe().unwrap_or_else(|e| panic!("no path of this test: {e}"));
    let found = test.ancestors().skip(1).take(2).map(|d| d.join(name)).find(|p| p.is_file());
    found.unwrap_or_else(|| panic!("no {name} beside {}: build the whole workspace", test.display()))
}

/// The binary, in the target folder of the running test.
pub fn grainlab() -> PathBuf {
    built("grainlab")
}

/// A program of `tests/examples`, in the target folder of the running test.
pub fn example(name: &str) -> PathBuf {
    built(&format!("examples/{name}"))
}

/// A file under `tests/golden`.
pub fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("golden").join(name)
}

/// A domain without participants on this host.
fn free_domain() -> u16 {
    static NEXT: AtomicU16 = AtomicU16::new(0);
    // Launchers without a domain take the first free ones; those above 101 overlap with the ephemeral ports.
    let start = (std::process::id() % 97) as u16;
    for _ in 0..82 {
        let domain = 20 + (start + 13 * NEXT.fetch_add(1, Ordering::Relaxed)) % 82;
        if !is_in_use(domain) {
            return domain;
        }
    }
    panic!("no free DDS domain on this host");
}
