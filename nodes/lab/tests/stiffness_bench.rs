//! `grainlab bench stiffness`: what it reports, not how fast it is.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn stiffness(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab"));
    command.args(["bench", "stiffness"]).args(arguments).stdin(Stdio::null()).output().unwrap()
}

fn reference() -> String {
    let path = "../../tests/golden/reference/ref_packing_500.csv.gz";
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path).display().to_string()
}

fn rows(arguments: &[&str]) -> Vec<Value> {
    let output = stiffness(&[arguments, &["--repetitions", "1", "--format", "json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice::<Value>(&output.stdout).unwrap().as_array().unwrap().clone()
}

#[test]
fn a_tighter_solve_takes_more_iterations_and_errs_less_and_affine_motion_errs_most() {
    let rows = rows(&["--packing", &reference(), "--tolerances", "1e-2,1e-4,1e-8"]);
    let of = |key: &str| rows.iter().map(|r| r[key].as_f64()).collect::<Vec<_>>();
    let methods: Vec<&str> = rows.iter().filter_map(|r| r["method"].as_str()).collect();
    assert_eq!(methods, ["affine", "network", "network", "network"]);
    assert!(of("error").is_sorted_by(|a, b| a > b), "{rows:?}");
    assert!(of("iterations")[1..].is_sorted_by(|a, b| a < b), "{rows:?}");
    // Affine motion overestimates the shear moduli of such a packing by more than half.
    assert!(of("error")[0].unwrap() > 0.3 && of("error")[3].unwrap() < 1e-12, "{rows:?}");
    assert!(of("seconds").iter().all(|s| s.unwrap() > 0.0));
}

#[test]
fn a_probe_of_a_small_strain_agrees_with_the_network_as_far_as_contacts_hold() {
    let rows = rows(&["--packing", &reference(), "--tolerances", "1e-8", "--amplitudes", "1e-7"]);
    let probe = rows.iter().find(|r| r["method"] == "probe").unwrap();
    assert!(probe["error"].as_f64().unwrap() < 1e-3, "{probe}");
}

#[test]
fn copies_of_a_packing_are_said_to_be_copies_and_as_stiff_as_the_packing() {
    let rows = rows(&["--packing", &reference(), "--grains", "500,4000", "--tolerances", "1e-6"]);
    let told: Vec<_> = rows.iter().map(|r| (r["grains"].as_u64(), r["replicated"].as_bool())).collect();
    assert_eq!(told[0], (Some(500), Some(false)));
    assert_eq!(told[2], (Some(4000), Some(true)));
    let [one, eight] = [&rows[0], &rows[2]].map(|r| r["error"].as_f64().unwrap());
    assert!((one - eight).abs() < 1e-8, "affine over relaxed: {one} {eight}");
}

#[test]
fn wrong_usage_is_refused_with_what_would_do() {
    for (arguments, code, word) in [
        (&["--tolerances", "1"][..], 2, "1e-13"),
        (&["--amplitudes", "0"], 2, "1e-12"),
        (&["--grains", "3000"], 2, "2000, 16000, 54000"),
        (&["--packing", "nowhere.csv"], 1, "nowhere.csv"),
    ] {
        let output = stiffness(arguments);
        let err = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {err}");
        assert!(err.contains(word), "{arguments:?}: {err}");
    }
}
