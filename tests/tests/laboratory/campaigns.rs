//! Campaigns: many runs, interrupted at any moment, gathered to the same bytes.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use serde_json::Value;
use system_tests::lab::{Lab, golden, grainlab, until};
use system_tests::process::{Process, children, send};
use system_tests::python;

/// Time limit of a campaign.
const LIMIT: Duration = Duration::from_secs(300);

/// A campaign of `tiny` with these seeds.
fn tiny(lab: &Lab, seeds: &str, more: &str) -> PathBuf {
    let path = lab.folder().join("tiny.toml");
    let scene = golden("scenes/tiny.toml");
    std::fs::write(&path, format!("name = 'tiny'\nscenes = [{scene:?}]\nseeds = {seeds}\n{more}")).unwrap();
    path
}

/// The tables of CSV; those of Parquet have the date.
fn gathered(lab: &Lab, out: &str) -> [Vec<u8>; 2] {
    let read = |name: &str| {
        let path = lab.folder().join(out).join(name);
        std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    };
    [read("states.csv"), read("groups.csv")]
}

/// Kills a process and everything that it started.
fn kill_tree(pid: u32) {
    let below = children(pid, "");
    send(pid, libc::SIGKILL);
    below.into_iter().for_each(kill_tree);
}

/// Waits until a member of the campaign has begun.
fn until_begun(folder: &Path) {
    let has_begun = |e: std::fs::DirEntry| e.path().join("launch.json").exists();
    let runs = || std::fs::read_dir(folder.join("members"));
    until("a member begins", || runs().is_ok_and(|runs| runs.flatten().any(has_begun)));
}

#[test]
fn a_campaign_killed_at_any_moment_goes_on_to_the_same_bytes() {
    let lab = Lab::new();
    let file = tiny(&lab, "[1, 2, 3, 5]", "");
    let file = file.to_string_lossy();
    let whole = lab.start(&["campaign", &file, "--out", "whole"]).ended(LIMIT);
    assert_eq!(whole.code, Some(0), "{}{}", whole.stdout, whole.stderr);
    for delay in [100, 500, 900] {
        let campaign = lab.start(&["campaign", &file, "--out", "killed"]);
        until_begun(&lab.folder().join("killed"));
        std::thread::sleep(Duration::from_millis(delay));
        kill_tree(campaign.pid());
    }
    let last = lab.start(&["campaign", &file, "--out", "killed"]).ended(LIMIT);
    assert_eq!(last.code, Some(0), "{}{}", last.stdout, last.stderr);
    assert_eq!(gathered(&lab, "killed"), gathered(&lab, "whole"));
}

#[test]
fn a_killed_member_is_continued_and_a_failed_one_costs_nothing_else() {
    let lab = Lab::new();
    let failing = "[[group]]\nscenes = ['demo']\nseeds = [9]\nset = { grains.count = 100, phase.rest.until.timeout = 1e-6 }";
    // Slow enough to be killed within the run.
    let slow = "set = { grains.count = 400, phase.gas.rate = -0.6 }";
    let file = tiny(&lab, "[1, 2]", &format!("{slow}\n{failing}"));
    let file = file.to_string_lossy();
    let campaign = lab.start(&["campaign", &file, "--out", "c", "--jobs", "2"]);
    let folder = lab.folder().join("c");
    until_begun(&folder);
    let launcher = loop {
        if let Some(pid) = children(campaign.pid(), "--seed 1").first() {
            break *pid;
        }
    };
    std::thread::sleep(Duration::from_millis(150));
    send(launcher, libc::SIGSTOP);
    let status = lab.run(&["campaign", "status", "c", "--format", "json"]);
    assert!(status.stdout.contains("\"state\": \"running\""), "{}", status.stdout);
    let early = lab.run(&["campaign", "gather", "c"]);
    assert!(early.code == Some(3) && early.stderr.contains(" of 3 members are not in"), "{}", early.stderr);
    send(launcher, libc::SIGKILL);
    let ended = campaign.ended(LIMIT);
    assert_eq!(ended.code, Some(4), "{}{}", ended.stdout, ended.stderr);
    assert!(ended.stderr.contains("tiny-1 was interrupted, and is continued"), "{}", ended.stderr);
    assert!(ended.stderr.contains("-9 failed: exit code 4: "), "{}", ended.stderr);
    let members = std::fs::read_dir(folder.join("members")).unwrap().map(|m| m.unwrap().path());
    let failed = members.into_iter().find(|m| m.to_string_lossy().ends_with("-9")).unwrap();
    let summary: Value =
        serde_json::from_slice(&std::fs::read(failed.join("summary.json")).unwrap()).unwrap();
    let reason = summary["warnings"][0].as_str().unwrap();
    assert!(reason.contains("(rest) did not meet its end conditions within"), "{summary}");
    let csv = String::from_utf8(gathered(&lab, "c")[0].clone()).unwrap();
    let rows: Vec<&str> = csv.lines().skip(1).map(|l| l.split(',').next().unwrap()).collect();
    assert_eq!(rows, ["tiny-1", "tiny-1", "tiny-2", "tiny-2"]);
    let status = lab.run(&["campaign", "status", "c"]);
    assert!(status.stdout.contains("3 members: 2 finished, 1 failed"), "{}", status.stdout);
    // Nothing is run again.
    let again = lab.start(&["campaign", &file, "--out", "c"]).ended(LIMIT);
    assert_eq!(again.code, Some(4), "{}", again.stderr);
    assert!(again.stderr.contains("2 of 3 members were done before"), "{}", again.stderr);
    assert!(!again.stderr.contains("-1 in ") && !again.stderr.contains("-2 in "), "{}", again.stderr);
}

#[test]
fn a_member_at_its_limit_of_memory_or_time_fails_and_harms_no_other() {
    let lab = Lab::new();
    let scene = golden("scenes/endless.toml");
    let cases = [
        ("--member-memory", "120", 200_000, "over the limit of 120 MiB"),
        ("--member-time", "3", 100, "3 seconds"),
    ];
    for (flag, limit, grains, reason) in cases {
        let group =
            format!("[[group]]\nscenes = [{scene:?}]\nseeds = [9]\nset = {{ grains.count = {grains} }}");
        let file = tiny(&lab, "[1, 2]", &group);
        let ended =
            lab.start(&["campaign", &file.to_string_lossy(), "--out", "limited", flag, limit]).ended(LIMIT);
        assert_eq!(ended.code, Some(1), "{}{}", ended.stdout, ended.stderr);
        let status = lab.run(&["campaign", "status", "limited"]);
        assert!(status.stdout.contains("3 members: 2 finished, 1 failed"), "{}", status.stdout);
        assert!(status.stdout.contains(reason), "{}", status.stdout);
        let csv = std::fs::read_to_string(lab.folder().join("limited/states.csv")).unwrap();
        assert_eq!(csv.lines().count(), 5, "{csv}");
        std::fs::remove_dir_all(lab.folder().join("limited")).unwrap();
    }
}

#[test]
fn a_directory_keeps_its_finished_run_and_refuses_another_one() {
    let lab = Lab::new();
    let scene = golden("scenes/tiny.toml").to_string_lossy().into_owned();
    let launch = |seed: &str| lab.run(&["launch", "--scene", &scene, "--seed", seed, "--run", "mine"]);
    let first = launch("1");
    assert_eq!(first.code, Some(0), "{}{}", first.stdout, first.stderr);
    let summary = std::fs::read(lab.folder().join("mine/summary.json")).unwrap();
    let second = launch("1");
    assert_eq!(second.code, Some(0), "{}", second.stderr);
    assert!(second.stderr.contains("the run is finished"), "{}", second.stderr);
    assert_eq!(std::fs::read(lab.folder().join("mine/summary.json")).unwrap(), summary);
    let other = launch("2");
    assert_eq!(other.code, Some(2), "{}", other.stderr);
    assert!(other.stderr.contains("another scene (line 3: `seed = "), "{}", other.stderr);
    // A launcher that was killed after the run, before it reported it.
    std::fs::remove_file(lab.folder().join("mine/summary.json")).unwrap();
    let third = launch("1");
    assert_eq!(third.code, Some(0), "{}{}", third.stdout, third.stderr);
    let [old, new] = [summary, std::fs::read(lab.folder().join("mine/summary.json")).unwrap()]
        .map(|text| serde_json::from_slice::<Value>(&text).unwrap()["states"].clone());
    assert_eq!(old, new);
}

#[test]
fn an_interrupted_run_leaves_no_row_that_looks_settled() {
    let lab = Lab::new();
    let scene = golden("scenes/endless.toml");
    let launcher = lab.start(&["launch", "--scene", &scene.to_string_lossy(), "--set", "grains.count=100"]);
    lab.until_recorded(200);
    launcher.signal(libc::SIGINT);
    let ended = launcher.ended(LIMIT);
    assert_eq!(ended.code, Some(130), "{}{}", ended.stdout, ended.stderr);
    let run = lab.last_run();
    let summary: Value = serde_json::from_slice(&std::fs::read(run.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["states"].as_array().unwrap().len(), 0, "{}", summary["states"]);
    assert_eq!(summary["within_phases"]["packings"], 1);
    let found = lab.run(&["analyze", &run.to_string_lossy(), "--format", "json"]);
    let states: Value = serde_json::from_str(&found.stdout).unwrap();
    let state = states.as_array().map_or(&states, |all| &all[0]);
    assert_eq!(state["end_of_phase"], false, "{}", found.stdout);
    assert!(state["warnings"].to_string().contains("had not met its end conditions"), "{}", found.stdout);
}

/// Expected: through a scheduler, the same bytes as on this machine.
fn through(engine: &str, lab: &Lab, command: &mut Command) -> Option<String> {
    let file = tiny(lab, "[1, 2, 3]", "");
    let local = lab.start(&["campaign", &file.to_string_lossy(), "--out", "local"]).ended(LIMIT);
    assert_eq!(local.code, Some(0), "{}{}", local.stdout, local.stderr);
    command.arg(grainlab()).args(["campaign", &file.to_string_lossy(), "--out", engine, "--engine", engine]);
    command.current_dir(lab.folder());
    let ended = Process::start(command).ended(LIMIT);
    if ended.code == Some(77) {
        return Some(ended.stderr);
    }
    assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
    assert_eq!(gathered(lab, engine), gathered(lab, "local"));
    None
}

#[test]
fn a_campaign_through_slurm_gives_the_same_bytes() {
    let lab = Lab::new();
    let node = concat!(env!("CARGO_MANIFEST_DIR"), "/tools/slurm_node.sh");
    let mut command = Command::new(node);
    command.arg(lab.folder().join("slurm-node"));
    if let Some(reason) = through("slurm", &lab, &mut command) {
        python::say_skipped(&reason);
    }
}

#[test]
fn a_campaign_whose_array_is_queued_is_not_submitted_again() {
    let lab = Lab::new();
    let file = tiny(&lab, "[1, 2, 3]", "").to_string_lossy().into_owned();
    let fakes = concat!(env!("CARGO_MANIFEST_DIR"), "/tools/fake_slurm");
    let path = format!("{fakes}:{}", std::env::var("PATH").unwrap());
    let words = ["campaign", &file, "--out", "c", "--engine", "slurm", "--time=9"];
    let start = || Process::start(lab.command(&words).env("PATH", &path));
    let [submitted, queued, down] = ["submitted", "queued", "down"].map(|name| lab.folder().join(name));
    let first = start();
    until("an array is submitted", || queued.exists());
    first.signal(libc::SIGINT);
    let first = first.ended(LIMIT);
    assert_eq!(first.code, Some(130), "{}", first.stderr);
    assert!(first.stderr.contains("at most 2 tasks here: each runs 2 members"), "{}", first.stderr);
    std::fs::write(&down, "").unwrap();
    let refused = start().ended(LIMIT);
    assert_eq!(refused.code, Some(1), "{}", refused.stderr);
    assert!(refused.stderr.contains("may still be queued or running"), "{}", refused.stderr);
    std::fs::remove_file(down).unwrap();
    let second = start();
    for task in ["1", "2"] {
        let mut sh = Command::new("sh");
        assert!(
            sh.arg(lab.folder().join("c/tasks.sh"))
                .env("SLURM_ARRAY_TASK_ID", task)
                .status()
                .unwrap()
                .success()
        );
    }
    std::fs::remove_file(queued).unwrap();
    let second = second.ended(LIMIT);
    assert_eq!(second.code, Some(0), "{}", second.stderr);
    assert!(second.stderr.contains("job 7 of this campaign is queued"), "{}", second.stderr);
    let submitted = std::fs::read_to_string(submitted).unwrap();
    assert!(
        submitted
            .starts_with("--parsable --array=1-2 --job-name=grainlab-tiny --ntasks=1 --time=9 --output=")
    );
    assert_eq!(submitted.lines().count(), 1, "{submitted}");
}

#[test]
fn a_campaign_through_hyperqueue_gives_the_same_bytes() {
    let Some(python) = python::with("hyperqueue") else { return };
    let lab = Lab::new();
    let mut command = Command::new("env");
    command.arg(format!("GRAINLAB_PYTHON={}", python.display()));
    assert_eq!(through("hq", &lab, &mut command), None);
}

#[test]
fn the_script_of_a_campaign_has_a_command_for_each_member() {
    let lab = Lab::new();
    let file = tiny(&lab, "{ first = 3, count = 2 }", "vary = { phase.load.friction = [0.1, 0.2] }");
    let printed = lab.run(&["campaign", &file.to_string_lossy(), "--engine", "print", "--out", "c"]);
    assert_eq!(printed.code, Some(0), "{}", printed.stderr);
    let lines: Vec<&str> = printed.stdout.lines().filter(|l| l.contains(" launch ")).collect();
    assert_eq!(lines.len(), 4, "{}", printed.stdout);
    assert!(
        lines[3].contains(
            "--seed 4 --set phase.load.friction=0.2 --record results --one-process --no-report --run "
        ),
        "{}",
        lines[3]
    );
    assert!(!lab.folder().join("c").exists());
}
