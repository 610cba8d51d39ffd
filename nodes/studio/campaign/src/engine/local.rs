//! Members on this machine, some at a time.

use super::limits::{Reached, reached, send};
use super::options::{Options, RETRIES};
use crate::campaign::Campaign;
use crate::command::command;
use crate::folder::{Folder, MemberState};
use crate::member::Member;
use crate::progress::Progress;
use grainlab_console::{Failure, Signals};
use grainlab_msgs::Exit;
use std::collections::VecDeque;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const POLL_PERIOD: Duration = Duration::from_millis(10);

#[derive(Clone, Copy, Debug)]
struct Task {
    member: usize,
    tries: u16,
}

struct Job {
    task: Task,
    process: Child,
    began: Instant,
    reached: Option<Reached>,
}

/// Runs these members; true if a signal ended the campaign.
pub(super) fn run(
    campaign: &Campaign,
    folder: &Folder,
    options: &Options,
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
            let process = start(campaign, folder, &campaign.members[task.member])?;
            running.push(Job { task, process, began: Instant::now(), reached: None });
            progress.running(running.len());
        }
        let mut n = 0;
        while n < running.len() {
            let job = &mut running[n];
            if job.process.try_wait().map_err(Failure::failed)?.is_none() {
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

fn start(campaign: &Campaign, folder: &Folder, member: &Member) -> Result<Child, Failure> {
    let words = command(campaign, folder, member)?;
    let path = folder.log(member);
    let failed = Failure::at(&path);
    let log = folder.open_log(member).map_err(Failure::failed)?;
    let mut command = Command::new(&words[0]);
    command.args(&words[1..]).stdin(Stdio::null()).stdout(log.try_clone().map_err(&failed)?).stderr(log);
    // Each run finds a free domain.
    command.env_remove("ROS_DOMAIN_ID");
    // A group of its own: Ctrl-C reaches the campaign, which passes it on.
    command.process_group(0);
    // SAFETY: prctl takes integers, accesses no memory, and may be called between fork and exec.
    unsafe {
        command.pre_exec(|| {
            // A campaign that is killed ends its runs.
            libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGTERM);
            Ok(())
        });
    }
    command.spawn().map_err(failed)
}
