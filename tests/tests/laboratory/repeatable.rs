//! A run is a pure function of scene and seed, in spite of crashes.

use std::time::{Duration, Instant};
use system_tests::bodies::{assert_same, distinct};
use system_tests::lab::{LIMIT, Lab, golden, until};
use system_tests::process::{children, runs, send};

/// The small scene with more grains and a slower start, by the contact law: long enough for five crashes.
fn longer_scene(lab: &Lab) -> std::path::PathBuf {
    let text = std::fs::read_to_string(golden("scenes/tiny.toml")).unwrap();
    let path = lab.folder().join("longer.toml");
    let slow = "method = \"soft\"\nrate = -12.0\ncontrol_period = 100";
    let fast = "method = \"event_driven\"\nrate = -60.0";
    assert!(text.contains(fast));
    std::fs::write(&path, text.replace("count = 80", "count = 400").replace(fast, slow)).unwrap();
    path
}

#[test]
fn two_runs_of_one_scene_and_seed_are_byte_identical_and_another_seed_is_not() {
    let (first, second, other) = (Lab::new(), Lab::new(), Lab::new());
    let scene = golden("scenes/tiny.toml");
    let (a, b) = (first.launch(&scene, &[]), second.launch(&scene, &[]));
    assert_same(&a, &b);
    let c = other.launch(&scene, &["--seed", "2"]);
    assert_ne!(distinct(&a, "/packing"), distinct(&c, "/packing"));
}

#[test]
fn killing_simulator_servo_analyzer_and_inversion_changes_no_byte() {
    let (quiet, deadly) = (Lab::new(), Lab::new());
    let expected = quiet.launch(&longer_scene(&quiet), &[]);

    let scene = longer_scene(&deadly);
    let mut launcher = deadly.start(&["launch", "--scene", &scene.to_string_lossy()]);
    let pid = launcher.pid();
    let mut victims = vec![
        "servo_controller",
        "fabric_analyzer",
        "dem_simulator",
        "servo_controller",
        "emt_inversion",
        "servo_controller",
    ];
    let begin = Instant::now();
    let mut last_kill = Instant::now();
    while let Some(node) = victims.first() {
        assert!(launcher.runs(), "the run ended with {victims:?} still to be killed");
        assert!(begin.elapsed() < LIMIT, "{victims:?} never appeared");
        // Long enough for a restarted servo to be discovered and to answer.
        let due = last_kill.elapsed() > Duration::from_millis(500);
        if let (true, [child]) = (due, children(pid, &format!("run {node}")).as_slice()) {
            send(*child, libc::SIGKILL);
            last_kill = Instant::now();
            victims.remove(0);
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let ended = launcher.ended(LIMIT);
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    assert_same(&expected, &deadly.last_run());
}

#[test]
fn a_run_that_was_interrupted_is_resumed_to_the_same_bytes() {
    let (quiet, broken) = (Lab::new(), Lab::new());
    let expected = quiet.launch(&longer_scene(&quiet), &[]);
    for (node, signal) in
        [("launch", libc::SIGKILL), ("run recorder", libc::SIGKILL), ("run dem_simulator", libc::SIGABRT)]
    {
        let scene = longer_scene(&broken);
        let out = node.replace(' ', "_");
        let launcher = broken.start(&["launch", "--scene", &scene.to_string_lossy(), "--out", &out]);
        // Named after scene, seed and number.
        let run = broken.folder().join(&out).join("tiny-3-1");
        until(node, || recorded(&run) >= 300);
        let nodes = children(launcher.pid(), "run ");
        match node {
            "launch" => launcher.signal(signal),
            _ => children(launcher.pid(), node).iter().for_each(|pid| send(*pid, signal)),
        }
        let ended = launcher.ended(LIMIT);
        if node == "run dem_simulator" {
            // The launcher resumes it automatically.
            assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
        } else {
            assert_ne!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
            // Processes whose launcher was killed end by themselves.
            until("every process ends", || !nodes.iter().any(|pid| runs(*pid)));
            let resumed = broken.run(&["launch", "--resume", &run.to_string_lossy()]);
            assert_eq!(resumed.code, Some(0), "{node}\n{}\n{}", resumed.stdout, resumed.stderr);
        }
        if node == "launch" {
            // The simulator saved its state when its launcher had ended: one packing more.
            for topic in ["/stress", "/strain_rate"] {
                assert!(distinct(&expected, topic) == distinct(&run, topic), "{topic}");
            }
            let (all, known) = (distinct(&run, "/packing"), distinct(&expected, "/packing"));
            assert!(known.iter().all(|body| all.contains(body)) && all.len() == known.len() + 1);
        } else {
            assert_same(&expected, &run);
        }
        let again = broken.run(&["launch", "--resume", &run.to_string_lossy()]);
        assert_eq!(again.code, Some(2), "{}", again.stderr);
    }
}

fn recorded(run: &std::path::Path) -> usize {
    let Ok(recording) = grainlab_recordings::Recording::open(run) else { return 0 };
    recording.messages(&grainlab_recordings::Selection::topics(["/stress"])).map_or(0, Iterator::count)
}
