//! Members as an array of tasks of a scheduler.

use super::{Options, pending};
use crate::campaign::Campaign;
use crate::command::{command, line};
use crate::folder::{Folder, MemberState};
use crate::progress::Progress;
use grainlab_console::Failure;
use std::collections::BTreeSet;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Period of the checks of the members.
const LOOK: Duration = Duration::from_millis(500);

/// A scheduler.
pub(super) struct Scheduler {
    /// Its name.
    name: &'static str,
    /// The command that submits an array and waits for its end.
    submit: &'static str,
    /// The variable with the number of a task.
    task: &'static str,
    /// Its arguments, for tasks 1 to n, a name, the folder of logs and a script.
    arguments: fn(usize, &str, &str, &str) -> Vec<String>,
    /// How to get it.
    advice: &'static str,
}

/// Slurm.
pub(super) const SLURM: Scheduler = Scheduler {
    name: "Slurm",
    submit: "sbatch",
    task: "SLURM_ARRAY_TASK_ID",
    arguments: |tasks, name, logs, script| {
        vec![
            "--wait".into(),
            format!("--array=1-{tasks}"),
            format!("--job-name={name}"),
            format!("--output={logs}/slurm-%A-%a.log"),
            "--ntasks=1".into(),
            script.into(),
        ]
    },
    advice: "is sbatch on the PATH, and does the controller answer `sinfo`?",
};

/// HyperQueue.
pub(super) const HYPER_QUEUE: Scheduler = Scheduler {
    name: "HyperQueue",
    submit: "hq",
    task: "HQ_TASK_ID",
    arguments: |tasks, name, logs, script| {
        vec![
            "submit".into(),
            "--wait".into(),
            format!("--array=1-{tasks}"),
            format!("--name={name}"),
            format!("--stdout={logs}/hq-%{{JOB_ID}}-%{{TASK_ID}}.log"),
            format!("--stderr={logs}/hq-%{{JOB_ID}}-%{{TASK_ID}}.log"),
            "--".into(),
            "sh".into(),
            script.into(),
        ]
    },
    advice: "is hq on the PATH, and do a server (`hq server start`) and a worker run?",
};

/// Runs the members that are not finished; true if a signal ended the wait. An array is submitted again for those that were
/// interrupted.
pub(super) fn run(
    scheduler: &Scheduler,
    campaign: &Campaign,
    folder: &Folder,
    options: Options,
    progress: &mut Progress,
) -> Result<bool, Failure> {
    let signals = grainlab_node_kit::Signals::install().map_err(Failure::failed)?;
    for tries in 0..=options.retries {
        let open = pending(campaign, folder);
        if open.is_empty() {
            break;
        }
        if tries > 0 && tries == options.retries {
            open.iter().try_for_each(|n| folder.remove(&campaign.members[*n]))?;
        }
        let mut process = submit(scheduler, campaign, folder, &open)?;
        let (began, mut done) = (Instant::now(), BTreeSet::new());
        let status = loop {
            for n in open.iter().filter(|n| !done.contains(*n)).copied().collect::<Vec<_>>() {
                let member = &campaign.members[n];
                match folder.state(member) {
                    MemberState::Finished => progress.finished(&member.name, began.elapsed()),
                    MemberState::Failed(_) => progress.failed(&member.name),
                    _ => continue,
                }
                done.insert(n);
            }
            if let Some(status) = process.try_wait().map_err(Failure::failed)? {
                break status;
            }
            if signals.requested() {
                grainlab_console::say!(
                    "grainlab: the tasks stay with {}; the same command continues the campaign",
                    scheduler.name
                );
                return Ok(true);
            }
            std::thread::sleep(LOOK);
        };
        // A scheduler that refuses the array starts none of its tasks.
        if !status.success() && pending(campaign, folder) == open && untouched(campaign, folder, &open) {
            return Err(Failure::failed(format!(
                "{} ended with {status}: {}",
                scheduler.submit, scheduler.advice
            )));
        }
    }
    Ok(false)
}

fn untouched(campaign: &Campaign, folder: &Folder, open: &[usize]) -> bool {
    open.iter().all(|n| folder.state(&campaign.members[*n]) == MemberState::Waiting)
}

/// Submits an array of these members.
fn submit(
    scheduler: &Scheduler,
    campaign: &Campaign,
    folder: &Folder,
    members: &[usize],
) -> Result<Child, Failure> {
    let task = scheduler.task;
    let mut script = format!(
        "#!/bin/sh\n# One member of the campaign {} for each task.\ncase ${task} in\n",
        campaign.name
    );
    for (n, member) in members.iter().map(|m| &campaign.members[*m]).enumerate() {
        script += &format!("{}) exec {} ;;\n", n + 1, line(&command(campaign, folder, member)?));
    }
    script += &format!("*) echo \"task ${task} is not of this campaign\" >&2; exit 2 ;;\nesac\n");
    let path = folder.write("tasks.sh", script)?;
    let logs = folder.logs();
    let arguments = (scheduler.arguments)(
        members.len(),
        &format!("grainlab-{}", campaign.name),
        &logs.to_string_lossy(),
        &path.to_string_lossy(),
    );
    let started =
        Command::new(scheduler.submit).args(arguments).stdin(Stdio::null()).stdout(Stdio::null()).spawn();
    started.map_err(|e| Failure::failed(format!("{}: {e}: {}", scheduler.submit, scheduler.advice)))
}
