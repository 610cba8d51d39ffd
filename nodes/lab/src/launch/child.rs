//! One process of a run, which cannot outlive the launcher.

use super::plan::NodePlan;
use crate::failure::Failure;
use crate::lifeline::VARIABLE;
use std::fs::{File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{ExitStatus, Stdio};
use std::time::Instant;
use tokio::process::Command;
use tokio::sync::mpsc::UnboundedSender;

/// A process that ended.
#[derive(Debug)]
pub(crate) struct Ended {
    /// Its place in the plan.
    pub(crate) index: usize,
    /// How it ended.
    pub(crate) status: io::Result<ExitStatus>,
}

/// A node and the process that runs it.
#[derive(Debug)]
pub(crate) struct Child {
    /// What was planned.
    pub(crate) plan: NodePlan,
    /// Process id while it runs.
    pub(crate) pid: Option<u32>,
    /// Process id of the latest process.
    pub(crate) last_pid: u32,
    /// Exit code of the last process that ended by itself; `None` if it runs or a signal ended it.
    pub(crate) code: Option<i32>,
    /// When it was started again.
    pub(crate) restarts: Vec<Instant>,
}

impl Child {
    /// Nothing is started yet.
    pub(crate) fn new(plan: NodePlan) -> Self {
        Self { plan, pid: None, last_pid: 0, code: None, restarts: Vec::new() }
    }

    /// Starts the node with its output in `<logs>/<name>.log`. Its end is sent to `ended`.
    pub(crate) fn start(
        &mut self,
        index: usize,
        domain: u16,
        logs: &Path,
        ended: &UnboundedSender<Ended>,
    ) -> Result<(), Failure> {
        let failed = |e: io::Error| Failure::failed(format!("{}: cannot be started: {e}", self.plan.name));
        let log = open_log(logs, &self.plan.name).map_err(failed)?;
        let mut command = Command::new(std::env::current_exe().map_err(failed)?);
        command
            .args(&self.plan.arguments)
            .env("ROS_DOMAIN_ID", domain.to_string())
            .env(VARIABLE, "1")
            .stdin(Stdio::piped())
            .stdout(log.try_clone().map_err(failed)?)
            .stderr(log)
            // A group of its own: Ctrl-C reaches the launcher alone, which ends the children in their order.
            .process_group(0);
        let mut process = command.spawn().map_err(failed)?;
        self.pid = process.id();
        self.last_pid = self.pid.unwrap_or(0);
        self.code = None;
        let ended = ended.clone();
        // Held open as long as the process runs; `wait` alone would close it at once.
        let lifeline = process.stdin.take();
        tokio::spawn(async move {
            let status = process.wait().await;
            drop(lifeline);
            // Nobody listens any more only when the launcher itself ends.
            let _ = ended.send(Ended { index, status });
        });
        Ok(())
    }

    /// Repeats the last errors of its log on stderr.
    pub(crate) fn quote_log(&self, logs: &Path) {
        let text = std::fs::read_to_string(log_path(logs, &self.plan.name)).unwrap_or_default();
        let errors: Vec<&str> =
            text.lines().filter(|l| l.contains("ERROR") || l.contains("panicked")).collect();
        errors.iter().skip(errors.len().saturating_sub(3)).for_each(|l| crate::output::say!("  {l}"));
    }

    /// Sends `signal` if it runs.
    pub(crate) fn signal(&self, signal: i32) {
        if let Some(pid) = self.pid.and_then(|p| i32::try_from(p).ok()) {
            // SAFETY: kill takes two integers. The process is ours and its end was not reported yet, so the id is its own.
            unsafe { libc::kill(pid, signal) };
        }
    }
}

fn open_log(logs: &Path, name: &str) -> io::Result<File> {
    std::fs::create_dir_all(logs)?;
    OpenOptions::new().create(true).append(true).open(log_path(logs, name))
}

fn log_path(logs: &Path, name: &str) -> PathBuf {
    logs.join(format!("{name}.log"))
}
