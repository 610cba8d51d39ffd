//! A recording played into fresh nodes, and read without any, says the same as the live run.

use serde_json::Value;
use std::time::{Duration, Instant};
use system_tests::bodies::distinct;
use system_tests::lab::{LIMIT, Lab, golden};

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
    // Results are handed to the file at once, so it can be read while it grows.
    let begin = Instant::now();
    while distinct(&out, "/microstructure").len() < 2 {
        assert!(begin.elapsed() < LIMIT, "the last packing was not inverted");
        std::thread::sleep(Duration::from_millis(100));
    }
    for node in [analyzer, inversion, recorder] {
        node.signal(libc::SIGINT);
        let ended = node.ended(LIMIT);
        assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    }
    for topic in ["/packing", "/fabric", "/moduli", "/microstructure"] {
        assert_eq!(distinct(&live, topic), distinct(&out, topic), "{topic}");
        assert_eq!(distinct(&live, topic).len(), 2, "{topic}");
    }
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
    // Nothing tells from outside that the analyzer has advertised; discovery takes 0.2 s on a quiet machine.
    std::thread::sleep(Duration::from_secs(3));
    let played =
        other.run(&["bag", "play", &live.to_string_lossy(), "--topics", "packing", "moduli", "--rate", "50"]);
    assert_eq!(played.code, Some(0), "{}", played.stderr);
    assert!(played.stderr.contains("/moduli"), "the topic left out is named:\n{}", played.stderr);
    analyzer.signal(libc::SIGTERM);
    assert_eq!(analyzer.ended(LIMIT).code, Some(0));
}
