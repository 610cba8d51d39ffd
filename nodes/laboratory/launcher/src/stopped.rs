//! Detects processes of a run that were stopped by a signal: Ctrl-Z, a debugger, `kill -STOP`.

use super::child::Child;
use grainlab_node_kit::processes::Status;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// The processes that were stopped at the last check.
#[derive(Debug, Default)]
pub(super) struct Stopped {
    pids: BTreeSet<u32>,
    /// Time at which one of them was last found to continue.
    resumed: Option<Instant>,
}

/// Changes since the previous check.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Changes {
    /// Names and process ids of newly stopped processes.
    pub(super) stopped: Vec<(String, u32)>,
    /// Names of the processes that continue.
    pub(super) resumed: Vec<String>,
}

impl Stopped {
    /// Checks every running process.
    pub(super) fn look(&mut self, children: &[Child]) -> Changes {
        let running = children.iter().filter_map(|c| Some((c.plan.name.clone(), c.pid?)));
        let mut changes = Changes::default();
        let mut now = BTreeSet::new();
        for (name, pid) in running {
            match (Status::of(pid).is_some_and(|s| s.is_stopped()), self.pids.contains(&pid)) {
                (true, known) => {
                    now.insert(pid);
                    if !known {
                        changes.stopped.push((name, pid));
                    }
                }
                (false, true) => changes.resumed.push(name),
                (false, false) => {}
            }
        }
        if !changes.resumed.is_empty() {
            self.resumed = Some(Instant::now());
        }
        self.pids = now;
        changes
    }

    /// True if any process was stopped at the last check, or within this time before it.
    pub(super) fn any_within(&self, time: Duration) -> bool {
        self.any() || self.resumed.is_some_and(|at| at.elapsed() < time)
    }

    /// True if any process was stopped.
    pub(super) fn any(&self) -> bool {
        !self.pids.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_is_stopped_between_its_two_signals() {
        let mut child = std::process::Command::new("sleep").arg("60").spawn().unwrap();
        let pid = child.id();
        let signal = |signal| {
            // SAFETY: kill takes two integers. The child was not waited for, so the id is its own.
            assert_eq!(unsafe { libc::kill(pid as i32, signal) }, 0);
            std::thread::sleep(std::time::Duration::from_millis(100));
        };
        let is_stopped = || Status::of(pid).unwrap().is_stopped();
        assert!(!is_stopped());
        signal(libc::SIGSTOP);
        assert!(is_stopped());
        signal(libc::SIGCONT);
        assert!(!is_stopped());
        child.kill().unwrap();
        child.wait().unwrap();
    }
}
