//! A run that measures its packings twice: by their contact network and by waves.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use system_tests::bodies::distinct;
use system_tests::lab::{LIMIT, Lab, appeared, golden, until};
use system_tests::process::send;

/// One run with a probe whose speeds have an error of 0.3 %, as in `grainlab launch acoustic`.
static RUN: LazyLock<(Lab, PathBuf)> = LazyLock::new(|| {
    let lab = Lab::new();
    let run = lab.launch(&golden("scenes/tiny.toml"), &["acoustic"]);
    (lab, run)
});

fn summary(run: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(run.join("summary.json")).unwrap()).unwrap()
}

/// Bodies of a topic, sorted: the order in which the kinds of data are inverted depends on timing.
fn bodies(run: &Path, topic: &str) -> Vec<Vec<u8>> {
    let mut bodies = distinct(run, topic);
    bodies.sort_unstable();
    bodies
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn both_kinds_of_data_are_recorded_inverted_and_agree() {
    let (_, run) = &*RUN;
    let summary = summary(run);
    for name in ["/wave_speeds", "/packing_report", "/microstructure"] {
        let topics = summary["topics"].as_array().unwrap();
        let topic =
            topics.iter().find(|t| t["name"] == name).unwrap_or_else(|| panic!("{name} in {topics:?}"));
        assert!(number(&topic["recorded"]) >= 2.0 && topic["lost"] == 0, "{topic}");
    }
    let states = summary["states"].as_array().unwrap();
    assert_eq!(states.len(), 2, "the scene publishes two packings");
    for state in states {
        let relaxed = |source: &str| {
            let results = state["results"].as_array().unwrap();
            let found = results.iter().find(|r| r["source"] == source && r["model"] == "relaxed");
            let found = found.unwrap_or_else(|| panic!("nothing inferred from {source}: {results:?}"));
            (number(&found["z"]), number(&found["sigma"]["z"]))
        };
        let ((z, sigma), (z_heard, sigma_heard)) = (relaxed("packing_report"), relaxed("wave_speeds"));
        let within = sigma.hypot(sigma_heard);
        assert!((z - z_heard).abs() < within, "z {z} +- {sigma} and {z_heard} +- {sigma_heard}");

        let acoustic = &state["acoustic"];
        assert_eq!(
            (&acoustic["method"], &acoustic["axis"]),
            (&"dispersion".into(), &vec![0.0, 0.0, 1.0].into())
        );
        // Rattlers do not move with a wave, so that the density is lower.
        let [density, bulk] = ["density", "density_bulk"].map(|key| number(&acoustic[key]));
        assert!(density > 0.8 * bulk && density < bulk, "{density} of {bulk}");
        // 80 grains differ by 12 % from any medium isotropic about an axis, so that two averages over
        // azimuths differ, too.
        for modulus in ["g12_pa", "g13_pa", "theta_pa"] {
            let [network, heard] = [&state[modulus], &acoustic[modulus]].map(number);
            assert!((heard / network - 1.0).abs() < 0.03, "{modulus}: {network}, heard {heard}");
        }
        // The stated error is 0.3 % of the speed, and the reported speed has an error of this size.
        for speed in acoustic["speeds"].as_array().unwrap() {
            assert!(number(&speed["stddev"]) >= 0.00295 * number(&speed["speed"]), "{speed}");
        }
    }
}

#[test]
fn recorded_wave_speeds_played_into_a_fresh_inversion_give_the_recorded_bytes() {
    let (_, run) = &*RUN;
    let replay = Lab::new();
    let out = replay.folder().join("again");
    let recorder = replay.start(&["bag", "record", "-a", "-o", &out.to_string_lossy()]);
    let inversion = replay.start(&["run", "emt_inversion"]);
    let run = run.to_string_lossy();
    let played = replay.run(&["bag", "play", &run, "--topics", "wave_speeds", "--min-subscribers", "2"]);
    assert_eq!(played.code, Some(0), "{}\n{}", played.stdout, played.stderr);
    until("the last speeds are inverted", || distinct(&out, "/microstructure").len() >= 2);
    for node in [inversion, recorder] {
        node.signal(libc::SIGINT);
        let ended = node.ended(LIMIT);
        assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    }
    let recorded = distinct(Path::new(&*run), "/microstructure");
    for body in distinct(&out, "/microstructure") {
        assert!(recorded.contains(&body), "an inversion that the run did not have");
    }
    assert_eq!(distinct(Path::new(&*run), "/wave_speeds"), distinct(&out, "/wave_speeds"));
}

#[test]
fn killing_the_probe_changes_no_byte() {
    let (_, quiet) = &*RUN;
    let lab = Lab::new();
    let scene = golden("scenes/tiny.toml");
    let launcher = lab.start(&["launch", "acoustic", "--scene", &scene.to_string_lossy()]);
    // After the start of the run, and before its first packing.
    lab.until_recorded(20);
    let probe = appeared(&launcher, "run acoustic_probe");
    send(probe, libc::SIGKILL);
    let ended = launcher.ended(LIMIT);
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    let run = lab.last_run();
    let nodes = summary(&run)["nodes"].clone();
    let probe = nodes.as_array().unwrap().iter().find(|n| n["name"] == "acoustic_probe").cloned();
    assert_eq!(probe.unwrap()["restarts"], 1, "{nodes}");
    for topic in ["/packing", "/packing_report", "/wave_speeds", "/microstructure"] {
        assert_eq!(bodies(quiet, topic), bodies(&run, topic), "{topic}");
    }
}

#[test]
fn grainlab_probe_of_a_recording_gives_the_results_of_the_live_probe() {
    let (lab, run) = &*RUN;
    let out = lab.folder().join("offline");
    let ended = lab.run(&[
        "probe",
        &run.to_string_lossy(),
        "--speed-noise",
        "0.003",
        "--format",
        "csv",
        "--record",
        &out.to_string_lossy(),
    ]);
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    assert_eq!(distinct(run, "/wave_speeds"), distinct(&out, "/wave_speeds"));
    let table = lab.folder().join("probed.csv");
    std::fs::write(&table, &ended.stdout).unwrap();
    let table = table.to_string_lossy();
    let judged = lab.run(&["invert", "--table", &table, "--judge", "--model", "relaxed", "--format", "json"]);
    assert_eq!(judged.code, Some(0), "{}\n{}", judged.stdout, judged.stderr);
    let scores: Value = serde_json::from_str(&judged.stdout).unwrap();
    assert!(judged.stdout.contains("\"z\"") && scores.is_array(), "{}", judged.stdout);
}
