//! The `grainlab` binary under test, in a separate folder and DDS domain.

use crate::bodies::recorded;
use crate::process::{Ended, Process, children};
use crate::wait::{LIMIT, until};
use grainlab_msgs::Topic;
use grainlab_node_kit::{Bus, DdsBus, Graph, Names, Network, is_in_use};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicU16, Ordering};
use std::sync::{Arc, LazyLock, Mutex, OnceLock};
use std::time::Duration;
use tempfile::TempDir;

/// Arguments of `grainlab launch` for a run of the small scene with more grains and a gas that takes some seconds.
pub const SLOW: [&str; 4] = ["--set", "grains.count=200", "--set", "phase.gas.rate=-0.6"];

/// Arguments for a run with more grains and a gas by the contact law: long enough for seven crashes.
pub const LONG: [&str; 8] = [
    "--set",
    "grains.count=400",
    "--set",
    "phase.gas.method='soft'",
    "--set",
    "phase.gas.rate=-12.0",
    "--set",
    "phase.gas.control_period=100",
];

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
        self.run(&arguments).assert_code(0);
        self.last_run()
    }

    /// Starts the launcher with a scene of `tests/golden` and these further arguments.
    pub fn start_launch(&self, scene: &str, extra: &[&str]) -> Process {
        let scene = scene_path(scene);
        self.start(&[&["launch", "--scene", &scene], extra].concat())
    }

    /// The small scene with texts replaced, as a file in the folder.
    pub fn tiny_with(&self, name: &str, replacements: &[(&str, &str)]) -> PathBuf {
        let mut text =
            std::fs::read_to_string(scene_path("tiny")).unwrap_or_else(|e| panic!("tiny.toml: {e}"));
        for (from, to) in replacements {
            assert!(text.contains(from), "tiny.toml has no {from:?}");
            text = text.replace(from, to);
        }
        self.write(name, &text)
    }

    /// Writes a file in the folder.
    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.folder().join(name);
        std::fs::write(&path, text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        path
    }

    /// Number of messages of `/stress` that the current run has recorded.
    pub fn recorded(&self) -> usize {
        let runs = std::fs::read_dir(self.folder().join("recordings/runs"));
        let run = runs.ok().and_then(|mut all| all.next()?.ok());
        run.map_or(0, |run| recorded(&run.path(), "/stress"))
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

/// The result of a run that nothing disturbs, of the small scene with these further arguments of `grainlab launch`. Each is
/// made once for all tests of this process, which read it and leave it as it is.
pub fn undisturbed(arguments: &[&str]) -> PathBuf {
    type Runs = HashMap<Vec<String>, Arc<OnceLock<PathBuf>>>;
    static LABS: Mutex<Vec<Lab>> = Mutex::new(Vec::new());
    static RUNS: LazyLock<Mutex<Runs>> = LazyLock::new(|| {
        extern "C" fn remove() {
            LABS.lock().unwrap_or_else(|e| e.into_inner()).clear();
        }
        // SAFETY: the function has the signature that is asked for, and unwinds never.
        unsafe { libc::atexit(remove) };
        Mutex::default()
    });
    let key = arguments.iter().map(|a| (*a).to_owned()).collect();
    let run = Arc::clone(RUNS.lock().unwrap_or_else(|e| e.into_inner()).entry(key).or_default());
    run.get_or_init(|| {
        let lab = Lab::new();
        let run = lab.start_launch("tiny", arguments).ended(LIMIT).assert_code(0);
        assert!(!run.stderr.contains("panicked"), "{}", run.stderr);
        let run = lab.last_run();
        LABS.lock().unwrap_or_else(|e| e.into_inner()).push(lab);
        run
    })
    .clone()
}

/// The summary of a run.
pub fn summary(run: &Path) -> serde_json::Value {
    json_file(&run.join("summary.json"))
}

/// A file of JSON.
pub fn json_file(path: &Path) -> serde_json::Value {
    let text = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_slice(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// A number in JSON.
pub fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// The path of a scene of `tests/golden`, as an argument.
pub fn scene_path(name: &str) -> String {
    golden(&format!("scenes/{name}.toml")).to_string_lossy().into_owned()
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
