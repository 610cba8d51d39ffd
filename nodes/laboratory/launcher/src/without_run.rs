//! Processes of a launch file that has no simulator: started, shown line by line, and ended together.

use crate::child::{command_of, end_with_launcher};
use crate::plan::NodePlan;
use grainlab_console::{Failure, print_more, say};
use grainlab_node_kit::Exit;
use std::collections::BTreeMap;
use std::io;
use std::process::{ExitStatus, Stdio};
use std::time::Duration;
use tokio::io::{AsyncBufReadExt, AsyncRead, BufReader};
use tokio::signal::unix::{SignalKind, signal};
use tokio::task::JoinSet;
use tokio::time::sleep;

/// Time before a process that ended is started again, and time after which one that does not end is killed.
const PAUSE: Duration = Duration::from_secs(1);
const LONGEST: Duration = Duration::from_secs(10);

/// Processes that run, by their places in the launch file.
struct Running {
    plans: Vec<NodePlan>,
    domain: u16,
    pids: BTreeMap<usize, i32>,
    ends: JoinSet<(usize, io::Result<ExitStatus>)>,
}

impl Running {
    fn start(&mut self, index: usize) -> Result<(), Failure> {
        let plan = &self.plans[index];
        let failed = |e: io::Error| Failure::failed(format!("{}: cannot be started: {e}", plan.name));
        let mut command = command_of(plan, self.domain).map_err(failed)?;
        end_with_launcher(&mut command);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut process = command.spawn().map_err(failed)?;
        self.pids.extend(process.id().and_then(|pid| Some((index, i32::try_from(pid).ok()?))));
        let name = plan.name.clone();
        let (out, err) = (process.stdout.take(), process.stderr.take());
        self.ends.spawn(async move {
            tokio::join!(show(&name, out), show(&name, err));
            (index, process.wait().await)
        });
        Ok(())
    }

    fn signal(&self, signal: i32) {
        for pid in self.pids.values() {
            // SAFETY: kill takes two integers. The process is a child that was not waited for, so the id is its own.
            unsafe { libc::kill(*pid, signal) };
        }
    }
}

/// Prints the lines of a process, each with its name before it.
async fn show(name: &str, pipe: Option<impl AsyncRead + Unpin>) {
    let Some(pipe) = pipe else { return };
    let mut lines = BufReader::new(pipe).lines();
    while let Ok(Some(line)) = lines.next_line().await {
        _ = print_more(&format!("[{name}] {line}\n"));
    }
}

/// Starts the processes, and waits until all have ended: by themselves, by SIGINT or SIGTERM of this process, or because one whose
/// end is that of all (`on_exit: shutdown`) has.
///
/// # Errors
/// A process that cannot be started; the others are ended.
pub async fn start_all(plans: Vec<NodePlan>, domain: u16) -> Result<Exit, Failure> {
    let listen = |kind| signal(kind).map_err(Failure::failed);
    let (mut interrupt, mut terminate) = (listen(SignalKind::interrupt())?, listen(SignalKind::terminate())?);
    let mut running = Running { plans, domain, pids: BTreeMap::new(), ends: JoinSet::new() };
    let started = (0..running.plans.len()).try_for_each(|index| running.start(index));
    let (mut exit, mut is_ending) = (Exit::Done, started.is_err());
    if is_ending {
        running.signal(libc::SIGINT);
    }
    while !running.ends.is_empty() {
        let ended = tokio::select! {
            _ = interrupt.recv() => None,
            _ = terminate.recv() => None,
            ended = running.ends.join_next() => ended.and_then(Result::ok),
            () = sleep(LONGEST), if is_ending => {
                running.signal(libc::SIGKILL);
                continue;
            }
        };
        let Some((index, status)) = ended else {
            (exit, is_ending) = (Exit::Interrupted, true);
            running.signal(libc::SIGINT);
            continue;
        };
        running.pids.remove(&index);
        let plan = &running.plans[index];
        let code = status.ok().and_then(|status| status.code());
        let (name, ends_all) = (plan.name.clone(), plan.ends_all);
        let text = code.map_or_else(|| "by a signal".to_owned(), |code| format!("with exit {code}"));
        say!("grainlab: {name} ended {text}");
        if is_ending {
            continue;
        }
        if plan.respawn {
            sleep(PAUSE).await;
            running.start(index)?;
            continue;
        }
        if code != Some(0) {
            exit = code.and_then(Exit::from_code).filter(|code| *code != Exit::Done).unwrap_or(Exit::Failure);
        }
        if ends_all {
            is_ending = true;
            running.signal(libc::SIGINT);
        }
    }
    started.map(|()| exit)
}
