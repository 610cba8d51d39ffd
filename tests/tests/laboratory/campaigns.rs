//! Campaigns: many runs, interrupted at any moment, gathered to the same bytes.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use system_tests::lab::{Lab, appeared, golden, grainlab, summary};
use system_tests::process::{Ended, Process, children, send};
use system_tests::python;
use system_tests::wait::until;

/// Time limit of a campaign.
const LIMIT: Duration = Duration::from_secs(300);

/// A campaign of `tiny` with these seeds.
fn tiny(lab: &Lab, seeds: &str, more: &str) -> PathBuf {
    let scene = golden("scenes/tiny.toml");
    lab.write("tiny.toml", &format!("name = 'tiny'\nscenes = [{scene:?}]\nseeds = {seeds}\n{more}"))
}

/// Runs the campaign of this file to its end.
fn campaign(lab: &Lab, words: &[&str]) -> Ended {
    lab.start(&[&["campaign", "tiny.toml", "--out"], words].concat()).ended(LIMIT)
}

/// The tables.
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

/// On this machine, after it was killed at any moment, through Slurm, and through HyperQueue.
#[test]
fn a_campaign_gives_the_same_bytes_however_it_is_run() {
    let lab = Lab::new();
    tiny(&lab, "[1, 2, 3, 5]", "");
    campaign(&lab, &["whole"]).assert_code(0);
    let whole = gathered(&lab, "whole");
    for delay in [100, 500, 900] {
        let campaign = lab.start(&["campaign", "tiny.toml", "--out", "killed"]);
        until_begun(&lab.folder().join("killed"));
        std::thread::sleep(Duration::from_millis(delay));
        kill_tree(campaign.pid());
    }
    campaign(&lab, &["killed"]).assert_code(0);
    assert_eq!(gathered(&lab, "killed"), whole);

    let through = |engine: &str, command: &mut Command| {
        command.arg(grainlab()).args(["campaign", "tiny.toml", "--out", engine, "--engine", engine]);
        let ended = Process::start(command.current_dir(lab.folder())).ended(LIMIT);
        if ended.code == Some(77) {
            return python::say_skipped(&ended.stderr);
        }
        ended.assert_code(0);
        assert_eq!(gathered(&lab, engine), whole);
    };
    let node = concat!(env!("CARGO_MANIFEST_DIR"), "/tools/slurm_node.sh");
    through("slurm", Command::new(node).arg(lab.folder().join("slurm-node")));
    if let Some(python) = python::with("hyperqueue") {
        through("hq", Command::new("env").arg(format!("GRAINLAB_PYTHON={}", python.display())));
    }
}

#[test]
fn a_killed_member_is_continued_and_a_failed_one_costs_nothing_else() {
    let lab = Lab::new();
    let failing = "[[group]]\nscenes = ['demo']\nseeds = [9]\nset = { grains.count = 100, phase.rest.until.timeout = 1e-6 }";
    // Slow enough to be killed within the run.
    let slow = "set = { grains.count = 200, phase.gas.rate = -0.6 }";
    tiny(&lab, "[1, 2]", &format!("{slow}\n{failing}"));
    let running = lab.start(&["campaign", "tiny.toml", "--out", "c", "--jobs", "2"]);
    let folder = lab.folder().join("c");
    until_begun(&folder);
    let launcher = appeared(&running, "--seed 1");
    std::thread::sleep(Duration::from_millis(150));
    send(launcher, libc::SIGSTOP);
    let status = ["campaign", "status", "c", "--format", "json"];
    lab.run(&status).assert_prints(&["\"state\": \"running\""]);
    lab.run(&["campaign", "gather", "c"]).assert_code(3).assert_says(&[" of 3 members are not in"]);
    send(launcher, libc::SIGKILL);
    running
        .ended(LIMIT)
        .assert_code(4)
        .assert_says(&["tiny-1 was interrupted, and is continued", "-9 failed: exit code 4: "]);
    let members = std::fs::read_dir(folder.join("members")).unwrap().map(|m| m.unwrap().path());
    let failed = members.into_iter().find(|m| m.to_string_lossy().ends_with("-9")).unwrap();
    let summary = summary(&failed);
    let reason = summary["warnings"][0].as_str().unwrap();
    assert!(reason.contains("(rest) did not meet its end conditions within"), "{summary}");
    let csv = String::from_utf8(gathered(&lab, "c")[0].clone()).unwrap();
    let rows: Vec<&str> = csv.lines().skip(1).map(|l| l.split(',').next().unwrap()).collect();
    assert_eq!(rows, ["tiny-1", "tiny-1", "tiny-2", "tiny-2"]);
    lab.run(&["campaign", "status", "c"]).assert_prints(&["3 members: 2 finished, 1 failed"]);
    // Nothing is run again.
    let again = campaign(&lab, &["c"]).assert_code(4).assert_says(&["2 of 3 members were done before"]);
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
        tiny(&lab, "[1, 2]", &group);
        campaign(&lab, &["limited", flag, limit]).assert_code(1);
        let status = lab.run(&["campaign", "status", "limited"]);
        status.assert_prints(&["3 members: 2 finished, 1 failed", reason]);
        let csv = std::fs::read_to_string(lab.folder().join("limited/states.csv")).unwrap();
        assert_eq!(csv.lines().count(), 5, "{csv}");
        std::fs::remove_dir_all(lab.folder().join("limited")).unwrap();
    }
}

#[test]
fn a_campaign_whose_array_is_queued_is_not_submitted_again() {
    let lab = Lab::new();
    tiny(&lab, "[1, 2, 3]", "");
    let fakes = concat!(env!("CARGO_MANIFEST_DIR"), "/tools/fake_slurm");
    let path = format!("{fakes}:{}", std::env::var("PATH").unwrap());
    let words = ["campaign", "tiny.toml", "--out", "c", "--engine", "slurm", "--time=9"];
    let start = || Process::start(lab.command(&words).env("PATH", &path));
    let [submitted, queued, down] = ["submitted", "queued", "down"].map(|name| lab.folder().join(name));
    let first = start();
    until("an array is submitted", || queued.exists());
    first.ended_by(libc::SIGINT).assert_code(130).assert_says(&["at most 2 tasks here: each runs 2 members"]);
    std::fs::write(&down, "").unwrap();
    start().ended(LIMIT).assert_code(1).assert_says(&["may still be queued or running"]);
    std::fs::remove_file(down).unwrap();
    let second = start();
    for task in ["1", "2"] {
        let mut sh = Command::new("sh");
        sh.arg(lab.folder().join("c/tasks.sh")).env("SLURM_ARRAY_TASK_ID", task);
        assert!(sh.status().unwrap().success());
    }
    std::fs::remove_file(queued).unwrap();
    second.ended(LIMIT).assert_code(0).assert_says(&["job 7 of this campaign is queued"]);
    let submitted = std::fs::read_to_string(submitted).unwrap();
    assert!(
        submitted
            .starts_with("--parsable --array=1-2 --job-name=grainlab-tiny --ntasks=1 --time=9 --output=")
    );
    assert_eq!(submitted.lines().count(), 1, "{submitted}");
}

#[test]
fn the_script_of_a_campaign_has_a_command_for_each_member_and_its_members_are_counted_and_gathered() {
    let lab = Lab::new();
    tiny(&lab, "{ first = 3, count = 2 }", "vary = { phase.load.friction = [0.1, 0.2] }");
    let printed = campaign(&lab, &["c", "--engine", "print"]).assert_code(0);
    let lines: Vec<&str> = printed.stdout.lines().filter(|l| l.contains(" launch ")).collect();
    assert_eq!(lines.len(), 4, "{}", printed.stdout);
    let last = "--seed 4 --set phase.load.friction=0.2 --record results --one-process --no-report --run ";
    assert!(lines[3].contains(last), "{}", lines[3]);
    lab.run(&["campaign", "status", "c"]).assert_code(0).assert_prints(&["4 waiting"]);
    let mut script = Command::new("sh");
    script.args(["-c", &printed.stdout]).current_dir(lab.folder());
    Process::start(&mut script).ended(LIMIT).assert_code(0);
    lab.run(&["campaign", "status", "c"]).assert_prints(&["4 finished"]);
    lab.run(&["campaign", "gather", "c"]).assert_code(0);
    let states = std::fs::read_to_string(lab.folder().join("c/states.csv")).unwrap();
    assert_eq!(states.lines().count(), 1 + 2 * 4);
}
