//! All nodes in one process: the bytes of separate processes, and an end that says what failed.

use grainlab_recordings::Recording;
use std::path::PathBuf;
use system_tests::bodies::{REPRODUCIBLE, distinct};
use system_tests::lab::{LIMIT, Lab, golden};

/// Launches with these arguments, and expects a complete run.
fn launched(lab: &Lab, arguments: &[&str]) -> PathBuf {
    let ended = lab.start(&[&["launch"], arguments].concat()).ended(LIMIT);
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    lab.last_run()
}

/// The small scene, slow enough to be interrupted.
fn slow(lab: &Lab) -> String {
    let text = std::fs::read_to_string(golden("scenes/tiny.toml")).unwrap();
    let path = lab.folder().join("slow.toml");
    std::fs::write(&path, text.replace("count = 80", "count = 200").replace("rate = -60.0", "rate = -0.6"))
        .unwrap();
    path.to_string_lossy().into_owned()
}

#[test]
fn one_process_records_the_bytes_of_many_and_says_so() {
    let lab = Lab::new();
    let scene = golden("scenes/tiny.toml").to_string_lossy().into_owned();
    let many = launched(&lab, &["acoustic", "--scene", &scene]);
    let one = launched(&lab, &["acoustic", "--scene", &scene, "--one-process"]);
    assert!(!distinct(&many, "/wave_speeds").is_empty() && !distinct(&many, "/clock").is_empty());
    for topic in REPRODUCIBLE.into_iter().chain(["/wave_speeds", "/clock"]) {
        assert!(distinct(&one, topic) == distinct(&many, topic), "{topic}");
    }
    for (run, transport) in [(&one, "memory"), (&many, "dds")] {
        let metadata = Recording::open(run).unwrap().metadata("grainlab").unwrap();
        assert_eq!(metadata.get("transport").map(String::as_str), Some(transport));
    }
    let checked = lab.run(&["bag", "check", &one.to_string_lossy()]);
    assert_eq!(checked.code, Some(0), "{}{}", checked.stdout, checked.stderr);
}

#[test]
fn results_alone_are_small_and_the_same() {
    let lab = Lab::new();
    let scene = golden("scenes/tiny.toml").to_string_lossy().into_owned();
    let whole = launched(&lab, &["--scene", &scene]);
    let flags = ["--scene", &scene, "--one-process", "--record", "results", "--no-report"];
    let run = launched(&lab, &[&flags[..], &["--set", "name='few'"]].concat());
    for topic in ["/packing_report", "/microstructure"] {
        assert!(distinct(&run, topic) == distinct(&whole, topic), "{topic}");
    }
    let channels = Recording::open(&run).unwrap().channels();
    assert!(channels.iter().all(|c| c.topic != "/stress") && !run.join("report.html").exists());
    for command in ["report", "analyze"] {
        let ended = lab.run(&[command, &run.to_string_lossy()]);
        assert_eq!(ended.code, Some(0), "{command}: {}{}", ended.stdout, ended.stderr);
    }
    let processes = ["--scene", &scene, "--record", "results", "--no-report", "--set", "name='many'"];
    assert!(distinct(&launched(&lab, &processes), "/packing_report") == distinct(&run, "/packing_report"));
}

#[test]
fn an_interrupted_or_killed_run_goes_on_in_one_process_to_the_same_bytes() {
    let whole = Lab::new();
    let expected = launched(&whole, &["--scene", &slow(&whole)]);
    for (name, signal, code) in [("asked", libc::SIGINT, Some(130)), ("killed", libc::SIGKILL, None)] {
        let lab = Lab::new();
        let launcher = lab.start(&["launch", "--one-process", "--scene", &slow(&lab)]);
        lab.until_recorded(20);
        let run = lab.last_run();
        let seen = lab.run(&["topic", "list"]);
        assert!(seen.stderr.contains("in one process, not on the bus"), "{}", seen.stderr);
        launcher.signal(signal);
        let ended = launcher.ended(LIMIT);
        assert_eq!(ended.code, code, "{}{}", ended.stdout, ended.stderr);
        let resumed = lab.run(&["launch", "--resume", &run.to_string_lossy()]);
        assert_eq!(resumed.code, Some(0), "{}{}", resumed.stdout, resumed.stderr);
        for topic in ["/stress", "/strain_rate"] {
            assert!(distinct(&run, topic) == distinct(&expected, topic), "{name}: {topic}");
        }
        for topic in ["/packing_report", "/microstructure"] {
            assert_eq!(distinct(&run, topic).last(), distinct(&expected, topic).last(), "{name}: {topic}");
        }
    }
}

#[test]
fn a_node_that_fails_ends_the_run_with_its_name_and_a_program_is_refused() {
    let lab = Lab::new();
    let failing = ["--scene", "demo", "--set", "grains.count=100", "--set", "phase.rest.until.timeout=1e-6"];
    let ended = lab.start(&[&["launch", "--one-process"], &failing[..]].concat()).ended(LIMIT);
    assert_eq!(ended.code, Some(4), "{}{}", ended.stdout, ended.stderr);
    assert!(ended.stderr.contains("dem_simulator ended with exit code 4: "), "{}", ended.stderr);
    assert!(ended.stderr.contains("(rest) did not meet its end conditions"), "{}", ended.stderr);
    let demo =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../nodes/launch/demo.launch.yaml"));
    let own = demo.unwrap() + "- executable:\n    cmd: sleep 1\n    name: instrument\n";
    std::fs::write(lab.folder().join("own.launch.yaml"), own).unwrap();
    let refused = lab.run(&["launch", "own.launch.yaml", "--one-process"]);
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    assert!(refused.stderr.contains("instrument: one process has no other programs"), "{}", refused.stderr);
}
