//! Recorders that were killed at any moment: their files are completed, and every tool reads them.

use std::path::Path;
use std::time::Duration;

use grainlab_recordings::{Recording, Selection};
use system_tests::lab::{LIMIT, Lab, appeared, golden};
use system_tests::process::send;
use system_tests::python;

type Said = (String, u32, u64, u64, Vec<u8>);

fn said(run: &Path) -> Vec<Said> {
    let recording = Recording::open(run).unwrap();
    let messages = recording.messages(&Selection::default()).unwrap();
    messages
        .map(|m| (m.channel.topic.clone(), m.sequence, m.log_time, m.publish_time, m.payload.to_vec()))
        .collect()
}

/// Kills the recorder of a run `delay` after its start; false if it had no file yet.
fn killed_after(lab: &Lab, delay: Duration) -> bool {
    let scene = golden("scenes/endless.toml");
    let launcher = lab.start(&["launch", "--scene", &scene.to_string_lossy()]);
    let recorder = appeared(&launcher, "run recorder");
    std::thread::sleep(delay);
    send(recorder, libc::SIGKILL);
    let ended = launcher.ended(LIMIT);
    assert!(!ended.stderr.contains("panicked"), "{}", ended.stderr);
    lab.folder().join("recordings/runs").exists() && Recording::open(&lab.last_run()).is_ok()
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
        if !killed_after(&lab, delay) {
            continue;
        }
        let run = lab.last_run();
        let path = run.to_string_lossy().into_owned();
        let before = said(&run);
        let complete = Recording::open(&run).unwrap().info().complete;
        let done = lab.run(&["bag", "recover", &path]);
        assert!(matches!(done.code, Some(0 | 3)), "{delay:?}: {}{}", done.stdout, done.stderr);
        assert!(complete || done.stdout.contains("recovered"), "{delay:?}: {}", done.stdout);
        assert_eq!(said(&run), before, "{delay:?}");
        let again = lab.run(&["bag", "recover", &path]);
        assert_eq!(again.code, Some(0), "{}{}", again.stdout, again.stderr);
        assert!(again.stdout.contains("nothing to do"), "{}", again.stdout);
        let check = lab.run(&["bag", "check", &path, "--format", "json"]);
        let report: serde_json::Value = serde_json::from_str(&check.stdout).unwrap();
        assert_eq!(report["warnings"], serde_json::json!([]), "{delay:?}: {}", check.stdout);
        assert_eq!(check.code, Some(0), "nothing is damaged any more: {}", check.stdout);
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
