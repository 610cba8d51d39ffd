//! Real processes: signals, exit codes, final counts, a failed DDS thread.
//!
//! A child is the example `role`, which `cargo test` builds with the tests, with the name of its role.

mod bystander;
mod flood;
mod fuzz;
mod leaving;
mod rtps;
mod stopping;

use grainlab_node_kit::{FreeDomain, Network};
use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Far above the time for discovery on an idle machine (0.2 s), so that the test passes on a loaded one.
const TIME_LIMIT: Duration = Duration::from_secs(30);

fn claim() -> FreeDomain {
    FreeDomain::take().expect("a free DDS domain")
}

/// A child process that is killed when the test fails.
struct Role {
    child: Child,
    name: &'static str,
    /// Read all the time, so that a child with much output does not block.
    out: Option<JoinHandle<String>>,
    err: Option<JoinHandle<String>>,
}

fn collect(mut pipe: impl Read + Send + 'static) -> JoinHandle<String> {
    std::thread::spawn(move || {
        let mut text = Vec::new();
        let _ = pipe.read_to_end(&mut text);
        String::from_utf8_lossy(&text).into_owned()
    })
}

impl Role {
    fn start(name: &'static str, network: Network) -> Self {
        // Cargo names no path of an example: tests are in `deps`, examples in the folder next to it.
        let tests = std::env::current_exe().unwrap();
        let role = tests.parent().unwrap().with_file_name("examples").join("role");
        let mut child = Command::new(role)
            .arg(name)
            .env("ROS_DOMAIN_ID", network.domain.to_string())
            .env_remove("ROS_AUTOMATIC_DISCOVERY_RANGE")
            .env_remove("ROS_LOCALHOST_ONLY")
            .env_remove("ROS_STATIC_PEERS")
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap_or_else(|e| panic!("examples/role: {e}: run without --test, which builds no examples"));
        let out = child.stdout.take().map(collect);
        let err = child.stderr.take().map(collect);
        Self { child, name, out, err }
    }

    fn signal(&self, signal: i32) {
        // SAFETY: kill accesses no memory; the pid is that of a child that was not reaped.
        assert_eq!(unsafe { libc::kill(self.child.id() as i32, signal) }, 0);
    }

    /// Waits for its end; returns exit code, stdout and stderr.
    fn end(mut self) -> (Option<i32>, String, String) {
        let start = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            assert!(start.elapsed() < TIME_LIMIT * 2, "{} did not end", self.name);
            std::thread::sleep(Duration::from_millis(20));
        };
        let text = |pipe: Option<JoinHandle<String>>| pipe.unwrap().join().unwrap();
        let (out, err) = (text(self.out.take()), text(self.err.take()));
        (status.code(), out, err)
    }
}

impl Drop for Role {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
