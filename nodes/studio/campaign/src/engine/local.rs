//! Members on this machine, some at a time.

use super::Launch;
use super::copied::Copied;
use super::limits::{Reached, reached, send};
use super::options::{Options, RETRIES};
use crate::campaign::Campaign;
use crate::folder::{Folder, MemberState};
use crate::member::Member;
use crate::progress::Progress;
use grainlab_console::{Failure, Signals};
use grainlab_msgs::Exit;
use std::collections::VecDeque;
use std::fs::OpenOptions;
use std::time::{Duration, Instant};

/// Period of the checks of the processes.
const POLL_PERIOD: Duration = Duration::from_millis(10);

/// A member to run, and how often it was tried.
#[derive(Clone, Copy, Debug)]
struct Task {
    member: usize,
    tries: u16,
}

/// A running member.
struct Job {
    task: Task,
    process: Copied,
    began: Instant,
    /// The limit that it reached.
    reached: Option<Reached>,
}

/// Runs these members; true if a signal ended the campaign.
pub(super) fn run(
    campaign: &Campaign,
    folder: &Folder,
    options: &Options,
    launch: Launch,
    pending: Vec<usize>,
    progress: &mut Progress,
) -> Result<bool, Failure> {
    let signals = Signals::install().map_err(Failure::failed)?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = options.jobs.map_or(cores + usize::from(options.processes), usize::from);
    let mut waiting: VecDeque<Task> = pending.into_iter().map(|member| Task { member, tries: 0 }).collect();
    let mut running: Vec<Job> = Vec::new();
    let (retries, mut told) = (options.retries.unwrap_or(RETRIES), false);
    while !running.is_empty() || (!waiting.is_empty() && !signals.requested()) {
        if signals.requested() && !told {
            told = true;
            // Each launcher ends its run in order, so that it can be continued.
            running.iter().for_each(|job| send(libc::SIGINT, job.process.id()));
        }
        while !signals.requested() && running.len() < jobs {
            let Some(task) = waiting.pop_front() else { break };
            if task.tries > 0 && task.tries >= retries {
                folder.remove(&campaign.members[task.member])?;
            }
            let process = start(folder, &campaign.members[task.member], launch)?;
            running.push(Job { task, process, began: Instant::now(), reached: None });
            progress.running(running.len());
        }
        let mut n = 0;
        while n < running.len() {
            let job = &mut running[n];
            if !job.process.has_ended().map_err(Failure::failed)? {
                let reached = reached(options, job.process.id(), job.began);
                // Once for each signal: a second interrupt would end it without its state.
                if let Some(new) =
                    reached.filter(|r| job.reached.as_ref().is_none_or(|o| o.signal != r.signal))
                {
                    send(new.signal, job.process.id());
                    job.reached = Some(new);
                }
                n += 1;
                continue;
            }
            let Job { task, began, reached, .. } = running.swap_remove(n);
            let member = &campaign.members[task.member];
            if let Some(limit) = reached.filter(|_| folder.state(member) != MemberState::Finished) {
                folder.fail(member, Exit::Failure.code(), &limit.reason)?;
            }
            match folder.state(member) {
                MemberState::Finished => progress.finished(&member.name, began.elapsed()),
                MemberState::Failed(_) => progress.failed(&member.name),
                _ if signals.requested() => {}
                _ if task.tries < retries => {
                    progress.again(&member.name);
                    waiting.push_front(Task { tries: task.tries + 1, ..task });
                }
                _ => {
                    folder.give_up(member)?;
                    progress.failed(&member.name);
                }
            }
            progress.running(running.len());
        }
        std::thread::sleep(POLL_PERIOD);
    }
    Ok(signals.requested())
}

/// Starts the run of a member; its output is appended to its log.
fn start(folder: &Folder, member: &Member, launch: Launch) -> Result<Copied, Failure> {
    let path = folder.log(member);
    let failed = Failure::at(&path);
    let log = OpenOptions::new().create(true).append(true).open(&path).map_err(&failed)?;
    Copied::start(&log, || {
        // SAFETY: the copy has one thread. Each run finds a free domain.
        unsafe { std::env::remove_var("ROS_DOMAIN_ID") };
        launch(member).code()
    })
    .map_err(failed)
}
