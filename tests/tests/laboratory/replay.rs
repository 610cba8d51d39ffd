//! A recording played into fresh nodes, and one read without nodes, have the results of the live run.

use grainlab_msgs::topics;
use serde_json::Value;
use std::path::Path;
use system_tests::bodies::distinct;
use system_tests::lab::{LIMIT, Lab, golden, until};

#[test]
fn a_recording_played_into_fresh_nodes_gives_the_recorded_bytes() {
    let lab = Lab::new();
    let live = lab.launch(&golden("scenes/tiny.toml"), &[]);

    let replay = Lab::new();
    let out = replay.folder().join("again");
    let recorder = replay.start(&["bag", "record", "-a", "-o", &out.to_string_lossy()]);
    let analyzer = replay.start(&["run", "fabric_analyzer"]);
    let inversion = replay.start(&["run", "emt_inversion"]);
    let played = replay.run(&[
        "bag",
        "play",
        &live.to_string_lossy(),
        "--topics",
        "packing",
        "--min-subscribers",
        "2",
    ]);
    assert_eq!(played.code, Some(0), "{}\n{}", played.stdout, played.stderr);
    // Results are written to the file at once, so that it can be read while it grows.
    until("the last packing is inverted", || distinct(&out, "/microstructure").len() >= 2);
    for node in [analyzer, inversion, recorder] {
        node.signal(libc::SIGINT);
        let ended = node.ended(LIMIT);
        assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    }
    for topic in ["/packing", "/packing_report", "/microstructure"] {
        assert_eq!(distinct(&live, topic), distinct(&out, topic), "{topic}");
        assert_eq!(distinct(&live, topic).len(), 2, "{topic}");
    }
    let both = [&live, &out].map(|path| path.to_str().unwrap());
    let results = ["--topics", "packing", "packing_report", "microstructure", "moduli"];
    let same = lab.run(&[&["bag", "diff"], &both[..], &results].concat());
    assert_eq!(same.code, Some(0), "{}{}", same.stdout, same.stderr);
}

/// The bodies of the analyzer node and those recorded by `analyze` are compared whole.
fn assert_same_results(one: &Path, other: &Path) {
    let [a, b] = [one, other].map(|run| distinct(run, "/packing_report"));
    assert_eq!((a.len(), b.len()), (2, 2));
    assert_eq!(a, b, "{} and {}", one.display(), other.display());
}

#[test]
fn analyze_records_the_bytes_that_the_live_analyzer_published() {
    let lab = Lab::new();
    let live = lab.launch(&golden("scenes/tiny.toml"), &[]);
    let (out, twice) = (lab.folder().join("offline"), lab.folder().join("twice"));
    for out in [&out, &twice] {
        let ended = lab.run(&["analyze", &live.to_string_lossy(), "--record", &out.to_string_lossy()]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert_same_results(&live, out);
    }
    let bytes = |run: &Path| {
        let name = format!("{}_0.mcap", run.file_name().unwrap().to_string_lossy());
        std::fs::read(run.join(name)).unwrap()
    };
    assert_eq!(bytes(&out), bytes(&twice), "nor does the file depend on the time of the day");
}

#[test]
fn analyze_of_a_recording_gives_the_numbers_of_the_live_run() {
    let lab = Lab::new();
    let live = lab.launch(&golden("scenes/tiny.toml"), &[]);
    let analyzed = lab.run(&["analyze", &live.to_string_lossy(), "--format", "json"]);
    assert_eq!(analyzed.code, Some(0), "{}", analyzed.stderr);
    let states: Value = serde_json::from_str(&analyzed.stdout).unwrap();
    let summary: Value = serde_json::from_slice(&std::fs::read(live.join("summary.json")).unwrap()).unwrap();
    for (state, recorded) in states.as_array().unwrap().iter().zip(summary["states"].as_array().unwrap()) {
        for key in [
            "step",
            "grains",
            "phi",
            "k",
            "z",
            "rattlers",
            "eps",
            "stiffness_pa",
            "g12_pa",
            "g13_pa",
            "theta_pa",
        ] {
            assert_eq!(state[key], recorded[key], "{key}");
            assert!(!state[key].is_null(), "{key}");
        }
    }
    assert_eq!(states.as_array().unwrap().len(), 2);
}

#[test]
fn play_skips_and_names_what_a_live_node_publishes() {
    let lab = Lab::new();
    let live = lab.launch(&golden("scenes/tiny.toml"), &[]);
    let other = Lab::new();
    let analyzer = other.start(&["run", "fabric_analyzer"]);
    other.until_announced(&topics::PACKING_REPORT);
    let played = other.run(&[
        "bag",
        "play",
        &live.to_string_lossy(),
        "--topics",
        "packing",
        "packing_report",
        "--rate",
        "50",
    ]);
    assert_eq!(played.code, Some(0), "{}", played.stderr);
    assert!(played.stderr.contains("/packing_report"), "the topic left out is named:\n{}", played.stderr);
    analyzer.signal(libc::SIGTERM);
    assert_eq!(analyzer.ended(LIMIT).code, Some(0));
}
