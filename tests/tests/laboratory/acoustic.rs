//! A run that measures its packings twice: by their contact network and by waves.

use std::path::{Path, PathBuf};
use system_tests::bodies::distinct;
use system_tests::lab::{Lab, appeared, number, scene_path, summary, undisturbed};
use system_tests::process::send;
use system_tests::wait::{LIMIT, until};

/// One run with a probe whose speeds have an error of 0.3 %, as in `grainlab launch acoustic`.
fn run() -> PathBuf {
    undisturbed(&["acoustic"])
}

/// Bodies of a topic, sorted: the order in which the kinds of data are inverted depends on timing.
fn bodies(run: &Path, topic: &str) -> Vec<Vec<u8>> {
    let mut bodies = distinct(run, topic);
    bodies.sort_unstable();
    bodies
}

#[test]
fn both_kinds_of_data_are_recorded_inverted_and_agree() {
    let summary = summary(&run());
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
    let (run, lab) = (run(), Lab::new());
    let out = lab.folder().join("again");
    let recorder = lab.start(&["bag", "record", "-a", "-o", "again"]);
    let inversion = lab.start(&["run", "emt_inversion"]);
    let subscribers = ["--topics", "wave_speeds", "--min-subscribers", "2"];
    lab.run(&[&["bag", "play", &run.to_string_lossy()], &subscribers[..]].concat()).assert_code(0);
    until("the last speeds are inverted", || distinct(&out, "/microstructure").len() >= 2);
    for node in [inversion, recorder] {
        node.ended_by(libc::SIGINT).assert_code(0);
    }
    let recorded = distinct(&run, "/microstructure");
    for body in distinct(&out, "/microstructure") {
        assert!(recorded.contains(&body), "an inversion that the run did not have");
    }
    assert_eq!(distinct(&run, "/wave_speeds"), distinct(&out, "/wave_speeds"));
}

#[test]
fn killing_the_probe_changes_no_byte() {
    let (quiet, lab) = (run(), Lab::new());
    let launcher = lab.start(&["launch", "acoustic", "--scene", &scene_path("tiny")]);
    // After the start of the run, and before its first packing.
    lab.until_recorded(20);
    send(appeared(&launcher, "run acoustic_probe"), libc::SIGKILL);
    launcher.ended(LIMIT).assert_code(0);
    let run = lab.last_run();
    let nodes = summary(&run)["nodes"].clone();
    let probe = nodes.as_array().unwrap().iter().find(|n| n["name"] == "acoustic_probe").cloned();
    assert_eq!(probe.unwrap()["restarts"], 1, "{nodes}");
    for topic in ["/packing", "/packing_report", "/wave_speeds", "/microstructure"] {
        assert_eq!(bodies(&quiet, topic), bodies(&run, topic), "{topic}");
    }
}

#[test]
fn grainlab_probe_of_a_recording_gives_the_bytes_of_the_live_probe() {
    let (run, lab) = (run(), Lab::new());
    let flags = ["--speed-noise", "0.003", "--record", "offline"];
    lab.run(&[&["probe", &run.to_string_lossy()], &flags[..]].concat()).assert_code(0);
    assert_eq!(distinct(&run, "/wave_speeds"), distinct(&lab.folder().join("offline"), "/wave_speeds"));
}
