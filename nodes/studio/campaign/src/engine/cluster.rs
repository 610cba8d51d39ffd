//! Members as an array of tasks of a scheduler.

use super::options::Options;
use crate::campaign::Campaign;
use crate::command::{command, line};
use crate::folder::{Folder, MemberState};
use crate::progress::Progress;
use grainlab_console::{Failure, Signals};
use std::collections::BTreeSet;
use std::fs::File;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Period of the checks of the members.
const POLL_PERIOD: Duration = Duration::from_millis(500);

/// A scheduler of jobs.
pub(super) struct Scheduler {
    name: &'static str,
    /// The number of a task, in a shell.
    task: &'static str,
    /// Program and arguments that submit an array and wait for its end.
    submit: fn(&Array<'_>) -> Result<Vec<String>, Failure>,
    /// Advice where it is missing.
    advice: &'static str,
}

/// Tasks 1 to n of a campaign.
struct Array<'a> {
    tasks: usize,
    folder: &'a Folder,
    /// Name of the job.
    name: String,
    /// Folder of the logs.
    logs: String,
    /// The script of a task.
    script: String,
}

/// The scheduler Slurm.
pub(super) const SLURM: Scheduler = Scheduler {
    name: "Slurm",
    task: "$SLURM_ARRAY_TASK_ID",
    submit: |array| {
        Ok(vec![
            "sbatch".into(),
            "--wait".into(),
            format!("--array=1-{}", array.tasks),
            format!("--job-name={}", array.name),
            format!("--output={}/slurm-%A-%a.log", array.logs),
            "--ntasks=1".into(),
            array.script.clone(),
        ])
    },
    advice: "is sbatch on the PATH, and does the controller answer `sinfo`?",
};

/// HyperQueue: the program hq, or without it the Python package.
pub(super) const HYPER_QUEUE: Scheduler = Scheduler {
    name: "HyperQueue",
    task: "${GRAINLAB_TASK:-$HQ_TASK_ID}",
    submit: |array| {
        let Array { tasks, folder, name, logs, script } = array;
        if is_on_path("hq") {
            let log = format!("{logs}/hq-%{{JOB_ID}}-%{{TASK_ID}}.log");
            return Ok(vec![
                "hq".into(),
                "submit".into(),
                "--wait".into(),
                format!("--array=1-{tasks}"),
                format!("--name={name}"),
                format!("--stdout={log}"),
                format!("--stderr={log}"),
                "sh".into(),
                script.clone(),
            ]);
        }
        let python = std::env::var("GRAINLAB_PYTHON").unwrap_or_else(|_| "python3".to_owned());
        let client = folder.write("hq.py", include_str!("hq.py"))?;
        let client = client.to_string_lossy().into_owned();
        Ok(vec![python, client, tasks.to_string(), script.clone(), logs.clone()])
    },
    advice: "is hq on the PATH, with a server and a worker, or is the Python package hyperqueue installed (GRAINLAB_PYTHON \
             names another Python)?",
};

fn is_on_path(program: &str) -> bool {
    let path = std::env::var_os("PATH");
    path.is_some_and(|path| std::env::split_paths(&path).any(|d| d.join(program).is_file()))
}

/// Runs the members that are not finished; true if a signal ended the wait. An array is submitted again for those that
/// were interrupted.
pub(super) fn run(
    scheduler: &Scheduler,
    campaign: &Campaign,
    folder: &Folder,
    options: Options,
    progress: &mut Progress,
) -> Result<bool, Failure> {
    let signals = Signals::install().map_err(Failure::failed)?;
    for tries in 0..=options.retries {
        let open = folder.pending(campaign);
        if open.is_empty() {
            break;
        }
        if tries > 0 && tries == options.retries {
            open.iter().try_for_each(|n| folder.remove(&campaign.members[*n]))?;
        }
        let mut process = submit(scheduler, campaign, folder, &open, options.processes)?;
        let (began, mut done) = (Instant::now(), BTreeSet::new());
        let status = loop {
            let ended = process.try_wait().map_err(Failure::failed)?;
            for n in &open {
                let member = &campaign.members[*n];
                let state = folder.state(member);
                if !matches!(state, MemberState::Finished | MemberState::Failed(_)) || !done.insert(*n) {
                    continue;
                }
                match state {
                    MemberState::Finished => progress.finished(&member.name, began.elapsed()),
                    _ => progress.failed(&member.name),
                }
            }
            if let Some(status) = ended {
                break status;
            }
            if signals.requested() {
                let name = scheduler.name;
                grainlab_console::say!(
                    "grainlab: the tasks stay with {name}; the same command continues the campaign"
                );
                return Ok(true);
            }
            std::thread::sleep(POLL_PERIOD);
        };
        // A scheduler that refuses the array starts none of its tasks.
        let untouched = |n: &usize| folder.state(&campaign.members[*n]) == MemberState::Waiting;
        if !status.success() && open.iter().all(untouched) {
            let Scheduler { name, advice, .. } = scheduler;
            let log = folder.logs().join("scheduler.log");
            let said = std::fs::read_to_string(log).unwrap_or_default();
            let last = said.lines().rfind(|l| !l.trim().is_empty()).unwrap_or_default();
            return Err(Failure::failed(format!("{name} ended with {status}: {last}: {advice}")));
        }
    }
    folder.pending(campaign).iter().try_for_each(|n| folder.give_up(&campaign.members[*n]))?;
    Ok(false)
}

/// Submits an array of these members.
fn submit(
    scheduler: &Scheduler,
    campaign: &Campaign,
    folder: &Folder,
    members: &[usize],
    processes: bool,
) -> Result<Child, Failure> {
    let task = scheduler.task;
    let mut script = format!(
        "#!/bin/sh\n# One member of the campaign {} for each task.\nunset ROS_DOMAIN_ID\ncase \"{task}\" in\n",
        campaign.name
    );
    for (n, member) in members.iter().map(|m| &campaign.members[*m]).enumerate() {
        script += &format!("{}) exec {} ;;\n", n + 1, line(&command(campaign, folder, member, processes)?));
    }
    script += &format!("*) echo \"task {task} is not of this campaign\" >&2; exit 2 ;;\nesac\n");
    let array = Array {
        tasks: members.len(),
        folder,
        name: format!("grainlab-{}", campaign.name),
        logs: folder.logs().to_string_lossy().into_owned(),
        script: folder.write("tasks.sh", script)?.to_string_lossy().into_owned(),
    };
    let words = (scheduler.submit)(&array)?;
    let failed = |e: std::io::Error| Failure::failed(format!("{}: {e}: {}", words[0], scheduler.advice));
    let log = File::create(folder.logs().join("scheduler.log")).map_err(failed)?;
    let mut command = Command::new(&words[0]);
    command.args(&words[1..]).stdin(Stdio::null()).stdout(log.try_clone().map_err(failed)?).stderr(log);
    command.spawn().map_err(failed)
}
