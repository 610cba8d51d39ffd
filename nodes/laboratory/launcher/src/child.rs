//! One process of a run, which ends with the launcher.

use super::plan::NodePlan;
use crate::pipe::VARIABLE;
use grainlab_console::{Failure, append_in, program};
use grainlab_node_kit::{MEMBER_VARIABLE, ROOT_VARIABLE, RUN_VARIABLE, RunId};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{ExitStatus, Stdio};
use std::time::Instant;
use tokio::process::Command;
use tokio::sync::mpsc::UnboundedSender;

/// The run that a launcher starts.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Id of the run.
    pub id: RunId,
    /// DDS domain of the run.
    pub domain: u16,
}

/// A process that ended.
#[derive(Debug)]
pub struct Ended {
    /// Index in the plan.
    pub index: usize,
    /// Exit status of the process.
    pub status: io::Result<ExitStatus>,
}

/// A node and the process that runs it.
#[derive(Debug)]
pub struct Child {
    /// Entry in the plan.
    pub plan: NodePlan,
    /// Process id while it runs.
    pub pid: Option<u32>,
    /// Member number in the run: the same after a restart.
    pub member: u8,
    /// Process id of the latest process.
    pub last_pid: u32,
    /// Exit code of the last process that ended by itself; `None` if it runs or a signal ended it.
    pub code: Option<i32>,
    /// The recording from which a restarted simulator resumes.
    pub resume_from: Option<PathBuf>,
    /// Times of its restarts.
    pub restarts: Vec<Instant>,
}

impl Child {
    /// A child that is not started yet.
    pub fn new(plan: NodePlan, member: u8) -> Self {
        Self { plan, member, pid: None, last_pid: 0, code: None, resume_from: None, restarts: Vec::new() }
    }

    /// Starts the node with its output in `<logs>/<name>.log`. Its end is sent to `ended`.
    pub fn start(
        &mut self,
        index: usize,
        run: &Run,
        logs: &Path,
        ended: &UnboundedSender<Ended>,
    ) -> Result<(), Failure> {
        let failed = |e: io::Error| Failure::failed(format!("{}: cannot be started: {e}", self.plan.name));
        let log = open_log(logs, &self.plan.name).map_err(failed)?;
        let mut command = command_of(&self.plan, run.domain).map_err(failed)?;
        if self.plan.node.is_some() {
            command.env(VARIABLE, "1");
        } else {
            end_with_launcher(&mut command);
        }
        if let Some(recording) = &self.resume_from {
            let path = serde_json::Value::from(recording.to_string_lossy());
            command.args(["--ros-args", "-p", &format!("resume:={path}")]);
        }
        command
            .env(RUN_VARIABLE, run.id.to_string())
            .env(MEMBER_VARIABLE, self.member.to_string())
            .env(ROOT_VARIABLE, std::process::id().to_string())
            .stdin(Stdio::piped())
            .stdout(log.try_clone().map_err(failed)?)
            .stderr(log);
        let mut process = command.spawn().map_err(failed)?;
        self.pid = process.id();
        self.last_pid = self.pid.unwrap_or(0);
        self.code = None;
        let ended = ended.clone();
        // Held open as long as the process runs; `wait` alone would close it at once.
        let pipe = process.stdin.take();
        tokio::spawn(async move {
            let status = process.wait().await;
            drop(pipe);
            // The receiver is closed only when the launcher itself ends.
            let _ = ended.send(Ended { index, status });
        });
        Ok(())
    }

    /// Repeats the first error of its log, often the cause, and the last two on stderr; of another program its last three lines.
    pub fn quote_log(&self, logs: &Path) {
        let text = std::fs::read_to_string(logs.join(log_name(&self.plan.name))).unwrap_or_default();
        let is_error = |l: &&str| self.plan.node.is_none() || l.contains("ERROR") || l.contains("panicked");
        let errors: Vec<&str> = text.lines().filter(is_error).collect();
        let first = usize::from(self.plan.node.is_some());
        let is_quoted = |n: usize| n < first || n + 3 - first >= errors.len();
        let quoted = errors.iter().enumerate().filter(|(n, _)| is_quoted(*n));
        quoted.for_each(|(_, line)| grainlab_console::say!("  {line}"));
    }

    /// Sends `signal` if it runs.
    pub fn signal(&self, signal: i32) {
        if let Some(pid) = self.pid.and_then(|p| i32::try_from(p).ok()) {
            // SAFETY: kill takes two integers. The process is a child and was not waited for, so the id is still its
            // own.
            unsafe { libc::kill(pid, signal) };
        }
    }
}

/// The command of an entry of the plan. Its group is its own: Ctrl-C reaches the launcher only, which ends the processes in order.
pub(crate) fn command_of(plan: &NodePlan, domain: u16) -> io::Result<Command> {
    let words = if plan.node.is_some() { program()? } else { vec![plan.program.clone().into()] };
    let mut command = Command::new(&words[0]);
    command
        .args(&words[1..])
        .args(&plan.arguments)
        .envs(plan.environment.iter().map(|(name, value)| (name, value)))
        .env("ROS_DOMAIN_ID", domain.to_string())
        .process_group(0);
    Ok(command)
}

/// A third-party program does not watch its standard input: the kernel ends it when the launcher has ended.
pub(crate) fn end_with_launcher(command: &mut Command) {
    // SAFETY: prctl takes integers, accesses no memory, and may be called between fork and exec.
    unsafe {
        command.pre_exec(|| {
            libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGTERM);
            Ok(())
        });
    }
}

pub(crate) fn open_log(logs: &Path, name: &str) -> io::Result<File> {
    append_in(logs, &log_name(name))
}

fn log_name(name: &str) -> String {
    format!("{name}.log")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_log_of_a_node_is_never_a_link_to_another_file() {
        let folder = tempfile::tempdir().unwrap();
        let other = folder.path().join("precious");
        std::os::unix::fs::symlink(&other, folder.path().join(log_name("servo"))).unwrap();
        let error = open_log(folder.path(), "servo").unwrap_err().to_string();
        assert!(error.contains("it is a link") && !other.exists(), "{error}");
    }
}
