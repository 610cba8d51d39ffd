//! Members as an array of tasks of a scheduler.

use super::array;
use super::options::{Engine, Options, RETRIES};
use crate::campaign::Campaign;
use crate::folder::{Folder, MemberState};
use crate::progress::Progress;
use grainlab_console::{Failure, Signals, say};
use std::collections::BTreeSet;
use std::fs::File;
use std::process::{Command, Output, Stdio};
use std::slice::Chunks;
use std::time::{Duration, Instant};

const POLL_PERIOD: Duration = Duration::from_millis(500);

const SLURM_TASK: &str = "$SLURM_ARRAY_TASK_ID";

const SLURM_ADVICE: &str = "is sbatch on the PATH, and does the controller answer `sinfo`?";

const HQ_ADVICE: &str = "is hq on the PATH, with a server and a worker, or is the Python package hyperqueue installed (GRAINLAB_PYTHON names \
                         another Python)?";

/// The client of Slurm for this action.
fn slurm(action: &str, campaign: &Campaign, folder: &Folder) -> Vec<String> {
    let jobs = folder.root().join("slurm.jobs").to_string_lossy().into_owned();
    ["sh", "-c", include_str!("slurm.sh"), action, &jobs, &job_name(campaign)].map(str::to_owned).into()
}

fn ask(action: &str, campaign: &Campaign, folder: &Folder) -> Result<String, Failure> {
    let words = slurm(action, campaign, folder);
    let output = Command::new(&words[0]).args(&words[1..]).stdin(Stdio::null()).output();
    let Output { status, stdout, stderr } = output.map_err(Failure::failed)?;
    if status.success() {
        return Ok(String::from_utf8_lossy(&stdout).trim().to_owned());
    }
    let said = String::from_utf8_lossy(&stderr);
    let advice = "try again when squeue answers, or submit another one by --submit-again";
    Err(Failure::failed(format!("{}: an array may still be queued or running: {advice}", said.trim())))
}

/// Runs the members that are not finished; true if a signal ended the wait. An array is submitted again for those that
/// were interrupted.
pub(super) fn run(
    campaign: &Campaign,
    folder: &Folder,
    options: &Options,
    progress: &mut Progress,
) -> Result<bool, Failure> {
    let signals = Signals::install().map_err(Failure::failed)?;
    let is_slurm = options.engine == Engine::Slurm;
    let (name, advice) = if is_slurm { ("Slurm", SLURM_ADVICE) } else { ("HyperQueue", HQ_ADVICE) };
    let asks = is_slurm && !options.submit_again;
    let mut queued = if asks { ask("queued", campaign, folder)? } else { String::new() };
    let retries = options.retries.unwrap_or(RETRIES);
    for tries in 0..=retries {
        let open = folder.pending(campaign);
        if open.is_empty() {
            break;
        }
        if tries > 0 && tries == retries {
            open.iter().try_for_each(|n| folder.remove(&campaign.members[*n]))?;
        }
        let words = match std::mem::take(&mut queued) {
            job if job.is_empty() => submission(campaign, folder, options, &open)?,
            job => {
                say!("grainlab: job {job} of this campaign is queued or running: waiting for its end");
                slurm("wait", campaign, folder)
            }
        };
        let failed = |e: std::io::Error| Failure::failed(format!("{}: {e}: {advice}", words[0]));
        let path = folder.logs().join("scheduler.log");
        // A link in its place is removed, not followed.
        let _ = std::fs::remove_file(&path);
        let log = File::create_new(&path).map_err(failed)?;
        let mut command = Command::new(&words[0]);
        command.args(&words[1..]).stdin(Stdio::null()).stdout(log.try_clone().map_err(failed)?).stderr(log);
        let mut process = command.spawn().map_err(failed)?;
        let (began, mut done) = (Instant::now(), BTreeSet::new());
        let status = loop {
            let ended = process.try_wait().map_err(Failure::failed)?;
            for n in &open {
                let member = &campaign.members[*n];
                match folder.state(member) {
                    MemberState::Finished if done.insert(*n) => {
                        let took = folder.standing(member).seconds.map(Duration::from_secs_f64);
                        progress.finished(&member.name, took.unwrap_or_else(|| began.elapsed()))
                    }
                    MemberState::Failed(_) if done.insert(*n) => progress.failed(&member.name),
                    _ => {}
                }
            }
            if let Some(status) = ended {
                break status;
            }
            if signals.requested() {
                say!("grainlab: the tasks stay with {name}; the same command continues the campaign");
                return Ok(true);
            }
            std::thread::sleep(POLL_PERIOD);
        };
        // A scheduler that refuses the array starts none of its tasks.
        let untouched = |n: &usize| folder.state(&campaign.members[*n]) == MemberState::Waiting;
        if open.iter().all(untouched) || (is_slurm && !status.success()) {
            let said = std::fs::read_to_string(path).unwrap_or_default();
            let last = said.lines().rfind(|l| !l.trim().is_empty()).unwrap_or_default();
            return Err(Failure::failed(format!(
                "{name} did not run the members that are left: {last}: {advice}"
            )));
        }
    }
    folder.pending(campaign).iter().try_for_each(|n| folder.give_up(&campaign.members[*n]))?;
    Ok(false)
}

fn job_name(campaign: &Campaign) -> String {
    format!("grainlab-{}", campaign.name)
}

pub(super) fn script(campaign: &Campaign, folder: &Folder, options: &Options) -> Result<String, Failure> {
    let all: Vec<usize> = (0..campaign.members.len()).collect();
    let (tasks, words) = plan(campaign, folder, options, &all)?;
    array::script(campaign, folder, tasks, SLURM_TASK, &words)
}

/// Tasks of these members, and for Slurm the options of sbatch.
fn plan<'a>(
    campaign: &Campaign,
    folder: &Folder,
    options: &Options,
    members: &'a [usize],
) -> Result<(Chunks<'a, usize>, Vec<String>), Failure> {
    // Without arrays, a limit below 1, sbatch says so.
    let most = ask("limit", campaign, folder)?.parse().unwrap_or(1).max(1);
    let tasks = array::tasks(members, options.chunk, most);
    let at_a_time = options.jobs.map_or_else(String::new, |n| format!("%{n}"));
    let array = format!("--array=1-{}{at_a_time}", tasks.len());
    let words = [array, format!("--job-name={}", job_name(campaign)), "--ntasks=1".into()].into_iter();
    Ok((tasks, words.chain(options.sbatch()).collect()))
}

/// The command that submits an array of these members and waits for its end.
fn submission(
    campaign: &Campaign,
    folder: &Folder,
    options: &Options,
    members: &[usize],
) -> Result<Vec<String>, Failure> {
    let logs = folder.logs().to_string_lossy().into_owned();
    let write = |tasks, task| {
        let path = folder.write("tasks.sh", array::script(campaign, folder, tasks, task, &[])?)?;
        Ok::<_, Failure>(path.to_string_lossy().into_owned())
    };
    if options.engine == Engine::Slurm {
        let (tasks, words) = plan(campaign, folder, options, members)?;
        let last = [format!("--output={logs}/slurm-%A-%a.log"), write(tasks, SLURM_TASK)?];
        return Ok([slurm("submit", campaign, folder), words, last.into()].concat());
    }
    let tasks = array::tasks(members, options.chunk, usize::MAX);
    let (count, script) = (tasks.len(), write(tasks, "${GRAINLAB_TASK:-$HQ_TASK_ID}")?);
    if Command::new("hq").arg("--version").output().is_ok() {
        let log = format!("{logs}/hq-%{{JOB_ID}}-%{{TASK_ID}}.log");
        let (array, name) = (format!("--array=1-{count}"), format!("--name={}", job_name(campaign)));
        let [stdout, stderr] = [format!("--stdout={log}"), format!("--stderr={log}")];
        let words = ["hq", "submit", "--wait", &array, &name, &stdout, &stderr, "sh", &script];
        return Ok(words.map(str::to_owned).into());
    }
    let python = std::env::var("GRAINLAB_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let client = folder.write("hq.py", include_str!("hq.py"))?.to_string_lossy().into_owned();
    Ok(vec![python, client, count.to_string(), script, logs])
}
