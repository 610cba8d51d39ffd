//! Crashes of each process of a run, and their consequences.

use std::path::Path;
use std::time::{Duration, Instant};
use system_tests::lab::{LIMIT, Lab, appeared, golden, until};
use system_tests::process::{Process, children, runs, send};

/// A run that does not end by itself, after some seconds; the launcher and the pid of `node`.
fn under_way(lab: &Lab, node: &str) -> (Process, u32) {
    let launcher = lab.start(&["launch", "--scene", &golden("scenes/endless.toml").to_string_lossy()]);
    let pid = appeared(&launcher, &format!("run {node}"));
    lab.until_recorded(200);
    (launcher, pid)
}

fn messages(run: &Path) -> usize {
    let recording = grainlab_recordings::Recording::open(run).unwrap();
    recording.messages(&grainlab_recordings::Selection::topics(["/stress"])).unwrap().count()
}

#[test]
fn a_simulator_that_is_killed_repeatedly_ends_the_run_with_exit_code_1_and_a_finished_recording() {
    let lab = Lab::new();
    let (launcher, first) = under_way(&lab, "dem_simulator");
    let mut victim = first;
    for _ in 0..4 {
        send(victim, libc::SIGKILL);
        let begin = Instant::now();
        while begin.elapsed() < Duration::from_secs(5) {
            match children(launcher.pid(), "run dem_simulator").as_slice() {
                [next] if *next != victim => {
                    victim = *next;
                    break;
                }
                _ => std::thread::sleep(Duration::from_millis(20)),
            }
        }
    }
    let ended = launcher.ended(LIMIT);
    assert_eq!(ended.code, Some(1), "{}\n{}", ended.stdout, ended.stderr);
    assert!(ended.stderr.contains("dem_simulator"), "{}", ended.stderr);
    let recording = grainlab_recordings::Recording::open(&lab.last_run()).unwrap();
    assert_eq!(recording.warnings().len(), 0, "{:?}", recording.warnings());
    assert!(messages(&lab.last_run()) > 100);
}

#[test]
fn a_killed_recorder_ends_the_run_with_exit_code_3_and_keeps_its_recording() {
    let lab = Lab::new();
    let (launcher, recorder) = under_way(&lab, "recorder");
    send(recorder, libc::SIGKILL);
    let ended = launcher.ended(LIMIT);
    assert_eq!(ended.code, Some(3), "{}\n{}", ended.stdout, ended.stderr);
    assert!(ended.stderr.contains("recorder"), "{}", ended.stderr);
    assert!(messages(&lab.last_run()) > 100, "half a second at most is lost");
}

#[test]
fn a_recorder_that_cannot_begin_ends_the_run_with_exit_code_1_and_one_error() {
    let lab = Lab::new();
    let tiny = golden("scenes/tiny.toml").to_string_lossy().into_owned();
    for how in [&[][..], &["--one-process"]] {
        // The file system of the run is too small for a recording.
        let script = "mkdir small; mount -t tmpfs -o size=3m none small && exec \"$@\"";
        let mut command = std::process::Command::new("unshare");
        command.args(["-m", "sh", "-c", script, "sh"]).arg(system_tests::lab::grainlab());
        command.args(["launch", "--scene", &tiny, "--run", "small/run"]).args(how).current_dir(lab.folder());
        let plain = lab.command(&[]);
        command.envs(plain.get_envs().filter_map(|(name, value)| Some((name, value?))));
        if !system_tests::hosts::can_isolate() {
            return;
        }
        let ended = command.output().unwrap();
        let err = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(1), "{err}");
        assert_eq!(err.matches("the recording was not begun").count(), 1, "{err}");
        assert!(!err.contains("contains no .mcap") && ended.stdout.is_empty(), "{err}");
        std::fs::remove_dir(lab.folder().join("small")).unwrap();
    }
}

#[test]
fn a_killed_launcher_ends_every_process_and_finishes_the_recording() {
    let lab = Lab::new();
    let (launcher, _) = under_way(&lab, "dem_simulator");
    let all = children(launcher.pid(), "run ");
    assert_eq!(all.len(), 5);
    launcher.signal(libc::SIGKILL);
    until("processes end with their launcher", || !all.iter().any(|pid| runs(*pid)));
    let recording = grainlab_recordings::Recording::open(&lab.last_run()).unwrap();
    assert_eq!(recording.warnings().len(), 0, "{:?}", recording.warnings());
}
