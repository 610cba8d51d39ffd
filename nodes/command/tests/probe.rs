//! `grainlab probe`: waves through packings from files.

use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

fn reference() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden/reference/ref_packing_500.csv.gz")
}

fn grainlab(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab"));
    command.args(arguments).stdin(Stdio::null()).output().unwrap()
}

/// The reference packing, probed with these flags, as JSON.
fn probed(flags: &[&str]) -> Value {
    let file = reference();
    let out = grainlab(&[&["probe", file.to_str().unwrap(), "--format", "json"], flags].concat());
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    let mut states: Value = serde_json::from_slice(&out.stdout).unwrap();
    states[0].take()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn the_waves_of_a_packing_made_elsewhere_have_the_moduli_of_its_network() {
    let state = probed(&[]);
    let a = &state["acoustic"];
    assert_eq!((&a["method"], a["speeds"].as_array().unwrap().len()), (&"dispersion".into(), 27));
    for modulus in ["g12_pa", "g13_pa", "theta_pa"] {
        let ratio = number(&a[modulus]) / number(&state[modulus]);
        assert!((ratio - 1.0).abs() < 0.01, "{modulus}: {ratio}");
    }
    let [density, bulk] = ["density", "density_bulk"].map(|key| number(&a[key]));
    // 24 of 500 grains are rattlers, and more rotate freely about two contacts.
    assert!(density < bulk * (1.0 - 24.0 / 500.0) && density > 0.9 * bulk, "{density} of {bulk}");
    // The counted truth is in the same row.
    assert!((number(&state["k"]) - 5.108).abs() < 1e-9 && (number(&state["z"]) - 5.361).abs() < 1e-3);
}

#[test]
fn noise_is_that_of_its_seed_and_part_of_every_stated_error() {
    let noisy = |seed: &str| probed(&["--survey", "three", "--speed-noise", "0.01", "--seed", seed]);
    let exact = probed(&["--survey", "three"]);
    let speeds = |state: &Value| state["acoustic"]["speeds"].as_array().unwrap().clone();
    let (first, other) = (noisy("1"), noisy("2"));
    assert_eq!(first["acoustic"], noisy("1")["acoustic"]);
    assert_ne!(first["acoustic"]["speeds"], other["acoustic"]["speeds"]);
    for (heard, exact) in speeds(&first).iter().zip(&speeds(&exact)) {
        let [v, stddev, truth] = [&heard["speed"], &heard["stddev"], &exact["speed"]].map(number);
        assert!(stddev >= 0.01 * truth && (v - truth).abs() < 5.0 * stddev && v != truth, "{heard} {exact}");
    }
}

#[test]
fn the_table_is_one_that_the_inversion_reads_and_judges() {
    let folder = tempfile::tempdir().unwrap();
    let (file, table) = (reference(), folder.path().join("probed.csv"));
    let flags = ["--speed-noise", "0.003", "--format", "csv"];
    let out = grainlab(&[&["probe", file.to_str().unwrap()], &flags[..]].concat());
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    std::fs::write(&table, &out.stdout).unwrap();
    let inverted = grainlab(&[
        "invert",
        "--table",
        table.to_str().unwrap(),
        "--judge",
        "--model",
        "relaxed",
        "--format",
        "csv",
    ]);
    let text = String::from_utf8(inverted.stdout).unwrap();
    assert_eq!(inverted.status.code(), Some(0), "{}", String::from_utf8_lossy(&inverted.stderr));
    for quantity in ["k", "z", "eps", "eps_stiffness"] {
        assert!(text.lines().any(|l| l.contains(&format!(",{quantity},"))), "{quantity} in\n{text}");
    }
}

#[test]
fn a_packing_that_carries_no_wave_is_reported_and_ends_with_exit_code_4() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pair.dump");
    let text = "ITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 1\n0 1\n0 1\n\
                ITEM: ATOMS id x y z radius\n1 0.1 0 0 0.1\n2 0.29 0 0 0.1\n";
    std::fs::write(&path, text).unwrap();
    let glass = ["--shear-modulus", "29e9", "--poisson", "0.2", "--density", "2500", "--friction", "0.3"];
    let probe = |format: &str| {
        grainlab(&[&["probe", path.to_str().unwrap(), "--format", format], &glass[..]].concat())
    };
    let out = probe("json");
    assert_eq!(out.status.code(), Some(4), "{}", String::from_utf8_lossy(&out.stderr));
    let states: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert!(states[0]["acoustic"].is_null(), "{states}");
    assert!(states[0]["warnings"].to_string().contains("no contact network"), "{states}");
    let csv = String::from_utf8(probe("csv").stdout).unwrap();
    let cells: Vec<usize> = csv.lines().map(|l| l.split(',').count()).collect();
    assert!(cells.len() == 2 && cells[0] == cells[1], "{csv}");
}

#[test]
fn everything_in_one_answer_is_about_the_axis_asked_for_which_it_names() {
    let axis = ["--axis=1,0,0", "--survey", "three"];
    let state = probed(&axis);
    let about = serde_json::json!([1.0, 0.0, 0.0]);
    assert_eq!((&state["reference_axis"], &state["acoustic"]["axis"]), (&about, &about));
    let file = reference();
    let analysed = grainlab(&["analyze", file.to_str().unwrap(), "--axis=1,0,0", "--format", "json"]);
    let analysed: Value = serde_json::from_slice(&analysed.stdout).unwrap();
    for key in ["g12_pa", "g13_pa", "eps", "axial_q_over_p"] {
        assert_eq!(state[key], analysed[0][key], "{key}");
    }
    let text = grainlab(&[&["probe", file.to_str().unwrap()], &axis[..]].concat());
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.contains("reference_axis") && text.contains("1.0000 0.0000 0.0000"), "{text}");
    assert!(text.contains("moduli about (1.000, 0.000, 0.000)"), "{text}");
    let unknown = probed(&["--axis", "unknown", "--survey", "everywhere"]);
    for k in 0..3 {
        let [packing, waves] = [&unknown["reference_axis"][k], &unknown["acoustic"]["axis"][k]].map(number);
        assert!((packing - waves).abs() < 1e-12, "{packing} {waves}");
    }
}

#[test]
fn invalid_flags_are_refused_by_name() {
    let file = reference();
    for (flags, word) in [
        (["--speed-noise", "2"], "speed_noise"),
        (["--axis", "up"], "axis"),
        (["--columns", "nonsense"], "--columns"),
        (["--frequencies", "-1"], "frequencies"),
    ] {
        let out = grainlab(&[&["probe", file.to_str().unwrap()], &flags[..]].concat());
        let err = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(out.status.code() == Some(2) && err.contains(word), "{flags:?}: {err}");
    }
    let out = grainlab(&["launch", "acustic"]);
    let err = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.code() == Some(2) && err.contains("demo, acoustic"), "{err}");
}
