//! What a user finds after a crash: an exit code that says so, and a recording that every tool reads.

use grainlab_recordings::{Recording, Selection};
use std::fs::File;
use std::io::Write;
use std::os::fd::AsRawFd;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;
use system_tests::bodies::recorded;
use system_tests::lab::{Lab, appeared, scene_path};
use system_tests::process::{Process, children, send};
use system_tests::python;
use system_tests::wait::{LIMIT, until};

#[test]
fn a_simulator_that_is_killed_repeatedly_ends_the_run_with_exit_code_1_and_a_finished_recording() {
    let lab = Lab::new();
    let mut launcher = lab.start_launch("endless", &[]);
    let mut victim = appeared(&launcher, "run dem_simulator");
    lab.until_recorded(200);
    for _ in 0..4 {
        send(victim, libc::SIGKILL);
        until("another simulator, or the end", || match children(launcher.pid(), "run dem_simulator")[..] {
            [next] if next != victim => (victim = next, true).1,
            _ => !launcher.runs(),
        });
    }
    launcher.ended(LIMIT).assert_code(1).assert_says(&["dem_simulator"]);
    let recording = Recording::open(&lab.last_run()).unwrap();
    assert_eq!(recording.warnings().len(), 0, "{:?}", recording.warnings());
    assert!(recorded(&lab.last_run(), "/stress") > 100);
}

#[test]
fn a_recorder_that_cannot_begin_ends_the_run_with_exit_code_1_and_one_error() {
    let (lab, scene) = (Lab::new(), scene_path("tiny"));
    for how in [&[][..], &["--one-process"]] {
        let words = [&["launch", "--scene", &scene, "--run", "small/run"], how].concat();
        let Some(mut command) = on_a_disk(&lab, "3m", &words) else { return };
        let ended = Process::start(&mut command).ended(LIMIT).assert_code(1);
        assert_eq!(ended.stderr.matches("the recording was not begun").count(), 1, "{}", ended.stderr);
        assert!(!ended.stderr.contains("contains no .mcap") && ended.stdout.is_empty(), "{}", ended.stderr);
    }
}

/// A command whose folder `small` is a disk of its own, of this size; `None` without the right to mount a disk.
fn on_a_disk(lab: &Lab, size: &str, words: &[&str]) -> Option<Command> {
    if !system_tests::hosts::can_isolate() {
        return None;
    }
    let script = format!("mkdir -p small; mount -t tmpfs -o size={size} none small && exec \"$@\"");
    let mut command = Command::new("unshare");
    command.args(["-m", "sh", "-c", &script, "sh"]).arg(system_tests::lab::grainlab()).args(words);
    command.current_dir(lab.folder());
    let plain = lab.command(&[]);
    command.envs(plain.get_envs().filter_map(|(name, value)| Some((name, value?))));
    Some(command)
}

/// The folder `small` of such a process, which stays when the process ends.
fn disk_of(lab: &Lab, process: &Process) -> (File, PathBuf) {
    let seen = format!("/proc/{}/root{}", process.pid(), lab.folder().join("small").display());
    let here = lab.folder().metadata().unwrap().dev();
    let mut disk = None;
    until("a disk", || {
        disk = File::open(&seen).ok().filter(|d| d.metadata().is_ok_and(|m| m.dev() != here));
        disk.is_some()
    });
    let disk = disk.unwrap();
    let path = format!("/proc/{}/fd/{}", std::process::id(), disk.as_raw_fd());
    (disk, path.into())
}

/// Waits for 100 requests, and takes all space from the recorder.
fn fill_once_recorded(disk: &Path, run: &str) {
    until("messages on the disk", || recorded(&disk.join(run), "/stress") > 100);
    let mut file = File::create(disk.join("others")).unwrap();
    while file.write_all(&[0; 4096]).is_ok() {}
}

#[test]
fn a_full_disk_ends_a_run_with_exit_code_3_and_the_run_and_its_recording_say_so() {
    let (lab, scene) = (Lab::new(), scene_path("endless"));
    for how in [&[][..], &["--one-process"]] {
        let words = [&["launch", "--scene", &scene, "--run", "small/run"], how].concat();
        let Some(mut command) = on_a_disk(&lab, "100m", &words) else { return };
        let launcher = Process::start(&mut command);
        let (_held, disk) = disk_of(&lab, &launcher);
        if how.is_empty() {
            a_full_disk_ends_bag_record(&lab);
        }
        fill_once_recorded(&disk, "run");
        let ended = launcher.ended(LIMIT).assert_code(3);
        assert!(!ended.stderr.contains("was killed"), "{}", ended.stderr);
        ended
            .assert_says(&["the recording ends early", "free space and run again"])
            .assert_prints(&["not counting 1 file whose recorder ended early"]);
        let info = lab.run(&["bag", "info", &disk.join("run").to_string_lossy()]);
        info.assert_prints(&["the recording ends early"]);
    }
}

/// `bag record` of the run in the domain ends with exit code 3, and its recording says why.
fn a_full_disk_ends_bag_record(lab: &Lab) {
    let command = on_a_disk(lab, "100m", &["bag", "record", "-a", "-o", "small/r"]);
    let recorder = Process::start(&mut command.expect("a disk"));
    let (_held, disk) = disk_of(lab, &recorder);
    fill_once_recorded(&disk, "r");
    recorder.ended(LIMIT).assert_code(3).assert_says(&["free space and run again"]);
    let check = lab.run(&["bag", "check", &disk.join("r").to_string_lossy()]).assert_code(3);
    assert!(!check.stdout.contains("was killed"), "{}", check.stdout);
    check.assert_prints(&["the recording ends early"]);
}

type Message = (String, u32, u64, u64, Vec<u8>);

fn messages(run: &Path) -> Vec<Message> {
    let recording = Recording::open(run).unwrap();
    let messages = recording.messages(&Selection::default()).unwrap();
    messages
        .map(|m| (m.channel.topic.clone(), m.sequence, m.log_time, m.publish_time, m.payload.to_vec()))
        .collect()
}

#[test]
fn the_recording_of_a_recorder_killed_at_any_moment_is_finished_and_loses_no_message() {
    let python = python::with("rosbags");
    let times = std::env::var("GRAINLAB_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(3u64);
    let mut recovered = 0;
    for n in 0..times {
        let lab = Lab::new();
        // From before its first message on.
        let delay = Duration::from_millis(400 + (n * 7919 + 1300) % 3000);
        let launcher = lab.start_launch("endless", &[]);
        let recorder = appeared(&launcher, "run recorder");
        std::thread::sleep(delay);
        send(recorder, libc::SIGKILL);
        let ended = launcher.ended(LIMIT);
        assert!(!ended.stderr.contains("panicked"), "{}", ended.stderr);
        if !lab.folder().join("recordings/runs").exists() || Recording::open(&lab.last_run()).is_err() {
            continue;
        }
        let run = lab.last_run();
        let path = run.to_string_lossy().into_owned();
        let before = messages(&run);
        let complete = Recording::open(&run).unwrap().info().complete;
        let done = lab.run(&["bag", "recover", &path]);
        assert!(matches!(done.code, Some(0 | 3)), "{delay:?}: {}{}", done.stdout, done.stderr);
        assert!(complete || done.stdout.contains("recovered"), "{delay:?}: {}", done.stdout);
        assert_eq!(messages(&run), before, "{delay:?}");
        lab.run(&["bag", "recover", &path]).assert_code(0).assert_prints(&["nothing to do"]);
        let report = lab.run(&["bag", "check", &path, "--format", "json"]).assert_code(0).json();
        assert_eq!(report["warnings"], serde_json::json!([]), "{delay:?}: nothing is damaged any more");
        assert_eq!(report["messages"].as_u64(), Some(before.len() as u64));
        if let Some(python) = &python {
            // rosbags opens no recording without a message.
            let output = python::tool(python, "check_mcap.py", &[&path]);
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            assert!(output.status.success() || before.is_empty(), "{delay:?}: {text}");
        }
        println!("killed after {delay:?}: {} messages, complete before: {complete}", before.len());
        recovered += u64::from(!complete);
    }
    println!("{recovered} of {times} recordings were recovered");
    assert!(recovered > 0);
}
