//! Processes outside a run change none of its bytes and no exit code, and are named.

use grainlab_msgs::topics;
use grainlab_recordings::{Recording, Selection};
use serde_json::Value;
use std::path::Path;
use std::time::{Duration, Instant};
use system_tests::bodies::assert_same;
use system_tests::forger::{FORGERIES, Forger, Forgery};
use system_tests::lab::{LIMIT, Lab, golden, until};

fn strangers(run: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(run.join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(summary["exit"], 0, "{summary}");
    summary["strangers"].as_array().unwrap().clone()
}

/// Number of messages from outside the run that the recorder left out.
fn ignored(run: &Path) -> u64 {
    let counts =
        |s: &Value| s["ignored"].as_object().unwrap().values().map(|n| n.as_u64().unwrap()).sum::<u64>();
    strangers(run).iter().map(counts).sum()
}

#[test]
fn a_launched_run_gives_the_same_bytes_under_forged_messages_and_names_the_stranger() {
    let scene = golden("scenes/tiny.toml");
    let quiet = Lab::new();
    let expected = quiet.launch(&scene, &[]);
    assert!(strangers(&expected).is_empty());
    for forgery in FORGERIES {
        let lab = Lab::new();
        let forger = Forger::start(lab.domain, forgery);
        let scene = scene.to_string_lossy();
        let ended = lab.run(&["launch", "--scene", &scene]);
        assert_eq!(ended.code, Some(0), "{forgery:?}\n{}\n{}", ended.stdout, ended.stderr);
        assert!(forger.sent() > 0, "{forgery:?}: nothing was forged");
        let run = lab.last_run();
        assert_same(&expected, &run);
        assert!(ignored(&run) > 0, "{forgery:?}: {:?}", strangers(&run));
        assert!(ended.stderr.contains("not of this run"), "{forgery:?}\n{}", ended.stderr);
        let info = lab.run(&["bag", "info", &run.to_string_lossy()]);
        assert!(info.stdout.contains("left out"), "{forgery:?}\n{}", info.stdout);
    }
}

#[test]
fn an_old_result_that_is_latched_does_not_end_a_run_early() {
    let scene = golden("scenes/tiny.toml");
    let quiet = Lab::new();
    let expected = quiet.launch(&scene, &[]);
    let last = Recording::open(&expected).unwrap();
    let last = last.messages(&Selection::topics(["/microstructure"])).unwrap().last().unwrap();
    let last: grainlab_msgs::msg::Microstructure = grainlab_msgs::from_cdr(&last.payload).unwrap();
    let lab = Lab::new();
    let _forger = Forger::start(lab.domain, Forgery::OldMicrostructure { step: last.source_step });
    assert_same(&expected, &lab.launch(&scene, &[]));
}

#[test]
fn an_inversion_started_before_the_run_changes_nothing() {
    let scene = golden("scenes/tiny.toml");
    let (quiet, lab) = (Lab::new(), Lab::new());
    let expected = quiet.launch(&scene, &[]);
    let _idle = lab.start(&[
        "run",
        "emt_inversion",
        "--ros-args",
        "-p",
        "models:=ratio",
        "-p",
        "gamma_over_delta:=zero",
    ]);
    lab.until_announced(&topics::MICROSTRUCTURE);
    for _ in 0..2 {
        let run = lab.launch(&scene, &[]);
        assert_same(&expected, &run);
        assert!(!strangers(&run).is_empty());
    }
}

#[test]
fn two_labs_in_one_domain_give_the_bytes_of_each_alone() {
    let scene = golden("scenes/tiny.toml");
    let path = scene.to_string_lossy();
    let shared = Lab::new();
    let solo = Lab::new();
    let expected = ["3", "4"].map(|seed| solo.launch(&scene, &["--seed", seed]));
    let first = shared.start(&["launch", "--scene", &path, "--seed", "3", "--out", "a"]);
    std::thread::sleep(Duration::from_millis(300));
    let second = shared.start(&["launch", "--scene", &path, "--seed", "4", "--out", "b"]);
    for (process, name, expected) in
        [(first, "a/tiny-3-1", &expected[0]), (second, "b/tiny-4-1", &expected[1])]
    {
        let ended = process.ended(LIMIT);
        assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
        assert_same(expected, &shared.folder().join(name));
    }
}

#[test]
fn by_hand_a_second_inversion_is_an_error_that_names_it_and_a_forged_result_is_left_out() {
    let scene = golden("scenes/tiny.toml");
    let path = scene.to_string_lossy();
    let quiet = Lab::new();
    let expected = quiet.launch(&scene, &[]);
    for (forgery, second) in
        [(Some(Forgery::EarlyAnswer), false), (Some(Forgery::Packing), false), (None, true)]
    {
        let lab = Lab::new();
        let folder = lab.folder().join("run");
        let output = format!("output:={}", folder.display());
        let stress = Selection::topics(["/stress"]);
        let scene = format!("scene:={path}");
        let mut others = vec![lab.start(&["run", "emt_inversion"]), lab.start(&["run", "fabric_analyzer"])];
        if second {
            others.push(lab.start(&[
                "run",
                "emt_inversion",
                "--ros-args",
                "-r",
                "__node:=other",
                "-p",
                "models:=ratio",
            ]));
        }
        others.push(lab.start(&["run", "servo_controller", "--ros-args", "-p", "min_readers:=2"]));
        let recorder = lab.start(&["run", "recorder", "--ros-args", "-p", &scene, "-p", &output]);
        let wait = "wait_for:=[stress,packing,clock]";
        let simulator = [
            "run",
            "dem_simulator",
            "--ros-args",
            "-p",
            &scene,
            "-p",
            wait,
            "-p",
            "min_readers:=2",
            "-p",
            "exit_when_finished:=true",
        ];
        let simulator = lab.start(&simulator);
        // After the start of the run, like the forger of answers: before it, two servos are an error.
        until("the run begins", || {
            Recording::open(&folder).is_ok_and(|r| r.messages(&stress).is_ok_and(|m| m.count() > 0))
        });
        let forger = forgery.map(|f| Forger::start(lab.domain, f));
        let ended = simulator.ended(LIMIT);
        let begin = Instant::now();
        while begin.elapsed() < Duration::from_secs(3) {
            std::thread::sleep(Duration::from_millis(100));
        }
        recorder.signal(libc::SIGINT);
        let recorded = recorder.ended(LIMIT);
        drop(forger);
        if second {
            assert_eq!(recorded.code, Some(1), "{}", recorded.stderr);
            assert!(
                recorded.stderr.contains("microstructure") && recorded.stderr.contains("pid"),
                "{}",
                recorded.stderr
            );
        } else if ended.code == Some(0) {
            assert_eq!(recorded.code, Some(0), "{forgery:?} {}", recorded.stderr);
            assert_same(&expected, &lab.folder().join("run"));
        } else {
            assert!(ended.stderr.contains("two writers of strain_rate"), "{forgery:?} {}", ended.stderr);
        }
    }
}
