//! `grainlab probe`: waves through packings from files.

use crate::{GLASS, REFERENCE, dump, grainlab};
use serde_json::Value;

/// The reference packing, probed with these flags, as JSON.
fn probed(flags: &[&str]) -> Value {
    let out = grainlab(&[&["probe", REFERENCE, "--format", "json"], flags].concat()).assert_code(0);
    let mut states: Value = out.json();
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
    let table = folder.path().join("probed.csv");
    let flags = ["--speed-noise", "0.003", "--format", "csv"];
    let out = grainlab(&[&["probe", REFERENCE], &flags[..]].concat()).assert_code(0);
    std::fs::write(&table, &out.stdout).unwrap();
    let judge = ["--judge", "--model=relaxed", "--format=csv", "--table", table.to_str().unwrap()];
    let inverted = grainlab(&[&["invert"], &judge[..]].concat());
    let text = inverted.stdout;
    assert_eq!(inverted.code, Some(0), "{}", inverted.stderr);
    for quantity in ["k", "z", "eps", "eps_stiffness"] {
        assert!(text.lines().any(|l| l.contains(&format!(",{quantity},"))), "{quantity} in\n{text}");
    }
}

#[test]
fn a_packing_that_carries_no_wave_is_reported_and_ends_with_exit_code_4() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pair.dump");
    std::fs::write(&path, dump(0.19, &[7])).unwrap();
    let probe = |format: &str| {
        grainlab(&[&["probe", path.to_str().unwrap(), "--format", format], &GLASS[..]].concat())
    };
    let out = probe("json").assert_code(4);
    let states: Value = out.json();
    assert!(states[0]["acoustic"].is_null(), "{states}");
    assert!(states[0]["warnings"].to_string().contains("no contact network"), "{states}");
    let csv = probe("csv").stdout;
    let cells: Vec<usize> = csv.lines().map(|l| l.split(',').count()).collect();
    assert!(cells.len() == 2 && cells[0] == cells[1], "{csv}");
}

#[test]
fn everything_in_one_answer_is_about_the_axis_asked_for_which_it_names() {
    let axis = ["--axis=1,0,0", "--survey", "three"];
    let state = probed(&axis);
    let about = serde_json::json!([1.0, 0.0, 0.0]);
    assert_eq!((&state["reference_axis"], &state["acoustic"]["axis"]), (&about, &about));
    let analysed = grainlab(&["analyze", REFERENCE, "--axis=1,0,0", "--format", "json"]);
    let analysed: Value = analysed.json();
    for key in ["g12_pa", "g13_pa", "eps", "axial_q_over_p"] {
        assert_eq!(state[key], analysed[0][key], "{key}");
    }
    let text = grainlab(&[&["probe", REFERENCE], &axis[..]].concat());
    let text = text.stdout;
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
    for (flags, word) in [
        (["--speed-noise", "2"], "\"speed_noise\" = 2"),
        (["--method", "ear"], "\"method\""),
        (["--wavelengths", "60,80"], "\"wavelengths\" has 2"),
        (["--shots", "many"], "\"shots\""),
        (["--axis", "up"], "axis"),
        (["--columns", "nonsense"], "--columns"),
        (["--frequencies", "-1"], "frequencies"),
    ] {
        let out = grainlab(&[&["probe", REFERENCE], &flags[..]].concat());
        out.assert_code(2).assert_says(&[word]);
    }
    let out = grainlab(&["launch", "acustic"]);
    out.assert_code(2).assert_says(&["demo, acoustic"]);
}
