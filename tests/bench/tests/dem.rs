//! `grainlab_bench dem`: its report, not its speed.

use serde_json::Value;
use std::process::{Command, Output, Stdio};

fn dem(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab_bench"));
    command.args(["dem"]).args(arguments).stdin(Stdio::null()).output().unwrap()
}

#[test]
fn every_case_has_a_row_and_the_packing_holds_together() {
    let cases =
        ["--grains", "2000", "--threads", "1,2", "--features", "coulomb,stuck", "--simd", "scalar,best"];
    let output =
        dem(&[&cases[..], &["--servo", "--steps", "50", "--repetitions", "1", "--format", "json"]].concat());
    let err = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{err}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 8);
    for row in rows {
        assert_eq!((row["grains"].as_u64(), row["servo"].as_bool()), (Some(2000), Some(true)));
        for key in ["particle_steps_per_second", "cpu_particle_steps_per_second", "ns_per_contact"] {
            assert!(row[key].as_f64().unwrap() > 0.0, "{key}: {row}");
        }
        // 5109 contacts at 99,984 Pa; 55 steps of 3e-8 s at rest have almost no effect.
        assert!((row["coordination"].as_f64().unwrap() - 5.109).abs() < 0.02, "{row}");
        assert!((row["pressure"].as_f64().unwrap() / 99_984.5 - 1.0).abs() < 1e-2, "{row}");
        // Results depend neither on threads nor on the instruction set.
        let same = |r: &&Value| r["features"] == row["features"];
        let first = rows.iter().find(same).unwrap();
        assert_eq!((&row["pressure"], &row["coordination"]), (&first["pressure"], &first["coordination"]));
    }
}

#[test]
fn without_features_the_default_packing_is_stepped_with_all_that_fit_its_friction() {
    let output = dem(&[
        "--grains",
        "2000",
        "--threads",
        "1",
        "--steps",
        "20",
        "--repetitions",
        "1",
        "--format",
        "json",
    ]);
    let err = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{err}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let features = report["rows"].as_array().unwrap().iter().map(|row| row["features"].as_str().unwrap());
    assert_eq!(features.collect::<Vec<_>>(), ["coulomb", "stuck"]);
}

#[test]
fn wrong_usage_of_the_bench_is_refused_with_what_would_do() {
    for (arguments, code, word) in [
        (&["--grains", "3000"][..], 2, "2000, 16000, 54000"),
        (&["--simd", "mmx"], 2, "avx512"),
        (&["--features", "sticky"], 2, "coulomb"),
        (&["--features", "frictionless"], 2, "its own features are coulomb"),
        (&["--threads", "0"], 2, "1..=1024"),
        (&["--packing", "nowhere.data"], 1, "nowhere.data"),
    ] {
        let output = dem(arguments);
        let err = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {err}");
        assert!(err.contains(word), "{word:?} is missing for {arguments:?}: {err}");
    }
}

/// The packing of 500 grains from LAMMPS, as if it had this friction.
fn with_friction(folder: &std::path::Path, friction: f64) -> String {
    let golden = concat!(env!("CARGO_MANIFEST_DIR"), "/../golden/reference/ref_packing_500");
    let sidecar = std::fs::read_to_string(format!("{golden}.json")).unwrap();
    let mut sidecar: Value = serde_json::from_str(&sidecar).unwrap();
    sidecar["mu_prep"] = friction.into();
    std::fs::write(folder.join("mine.json"), sidecar.to_string()).unwrap();
    std::fs::copy(format!("{golden}.csv.gz"), folder.join("mine.csv.gz")).unwrap();
    folder.join("mine.csv.gz").display().to_string()
}

#[test]
fn a_packing_keeps_its_friction_and_one_that_dissolves_has_no_rate() {
    let folder = tempfile::tempdir().unwrap();
    let stepped = |friction: f64| {
        let file = with_friction(folder.path(), friction);
        let flags = [
            "--grains",
            "500",
            "--threads",
            "1",
            "--steps",
            "4000",
            "--repetitions",
            "1",
            "--format",
            "json",
        ];
        dem(&[&["--packing", &file], &flags[..]].concat())
    };
    let kept = stepped(0.5);
    let err = String::from_utf8_lossy(&kept.stderr);
    assert_eq!(kept.status.code(), Some(0), "{err}");
    assert!(err.contains("friction 0.5"), "{err}");
    let rows: Value = serde_json::from_slice(&kept.stdout).unwrap();
    let rows = rows["rows"].as_array().unwrap();
    assert_eq!((rows.len(), &rows[0]["features"]), (1, &"coulomb".into()));
    assert!((rows[0]["coordination"].as_f64().unwrap() / 5.108 - 1.0).abs() < 0.02, "{rows:?}");
    let dissolved = stepped(0.001);
    let err = String::from_utf8_lossy(&dissolved.stderr);
    assert_eq!(dissolved.status.code(), Some(4), "{err}");
    assert!(err.contains("coordination number went from 5.108"), "{err}");
    assert!(dissolved.stdout.is_empty());
}
