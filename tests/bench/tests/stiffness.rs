//! `grainlab_bench stiffness`: its report, not its speed.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn stiffness(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab_bench"));
    command.args(["stiffness"]).args(arguments).stdin(Stdio::null()).output().unwrap()
}

fn reference() -> String {
    let path = "../golden/reference/ref_packing_500.csv.gz";
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path).display().to_string()
}

fn report(arguments: &[&str]) -> Value {
    let output = stiffness(&[arguments, &["--repetitions", "1", "--format", "json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn rows(arguments: &[&str]) -> Vec<Value> {
    report(arguments)["rows"].as_array().unwrap().clone()
}

fn error(row: &Value) -> f64 {
    row["error"].as_f64().unwrap()
}

#[test]
fn a_tighter_solve_takes_more_iterations_and_errs_less_and_affine_motion_errs_most() {
    let rows = rows(&["--packing", &reference(), "--tolerances", "1e-2,1e-4,1e-8"]);
    let of = |key: &str| rows.iter().map(|r| r[key].as_f64()).collect::<Vec<_>>();
    let methods: Vec<&str> = rows.iter().filter_map(|r| r["method"].as_str()).collect();
    assert_eq!(methods, ["affine", "mean_spin", "cg", "cg", "cg"]);
    let errors: Vec<f64> = rows.iter().map(error).collect();
    assert!(errors[..5].is_sorted_by(|a, b| a > b), "{rows:?}");
    assert!(of("iterations")[2..5].is_sorted_by(|a, b| a < b), "{rows:?}");
    // Affine motion overestimates the shear moduli of such a packing by more than half.
    assert!(errors[0] > 0.3 && errors[4] < 1e-12, "{rows:?}");
    assert!(of("seconds").iter().all(|s| s.unwrap() > 0.0));
}

#[test]
fn a_probe_of_a_small_strain_agrees_with_the_network_as_far_as_contacts_hold() {
    let rows = rows(&["--packing", &reference(), "--tolerances", "1e-8", "--amplitudes", "1e-7"]);
    let probe = rows.iter().find(|r| r["method"] == "probe").unwrap();
    assert!(error(probe) < 1e-3, "{probe}");
    assert!(probe["reference"].as_str().unwrap().contains("network"), "{probe}");
}

#[test]
fn copies_of_a_packing_are_marked_as_copies_and_as_stiff_as_the_packing() {
    let rows = rows(&["--packing", &reference(), "--grains", "4000", "--tolerances", "1e-6"]);
    let copies = |r: &Value| r["method"].as_str().unwrap().ends_with(", copies");
    let told: Vec<_> = rows.iter().map(|r| (r["grains"].as_u64(), copies(r))).collect();
    let [one, eight] = [(Some(500), false), (Some(4000), true)];
    assert_eq!(told, [one, one, one, eight, eight, eight]);
    let [one, eight] = [&rows[0], &rows[3]].map(error);
    assert!((one - eight).abs() < 1e-8, "affine over relaxed: {one} {eight}");
}

#[test]
fn packings_of_two_sizes_have_an_exponent_a_method_and_a_folder_gets_report_and_picture() {
    let out = std::env::temp_dir().join(format!("grainlab-stiffness-{}", std::process::id()));
    let built_in = "../golden/packings/packing_2000.data.gz";
    let built_in = Path::new(env!("CARGO_MANIFEST_DIR")).join(built_in).display().to_string();
    let arguments = ["--packing", &reference(), "--packing", &built_in, "--tolerances", "1e-4", "--out"];
    let report = report(&[&arguments[..], &[out.to_str().unwrap()]].concat());
    let exponents = report["exponents"].as_array().unwrap();
    let methods: Vec<_> = exponents.iter().filter_map(|e| e["method"].as_str()).collect();
    assert_eq!(methods, ["affine", "mean_spin", "cg"]);
    for exponent in exponents {
        assert_eq!(exponent["sizes"], serde_json::json!([500, 2000]), "{exponent}");
        assert!(exponent["exponent"].as_f64().unwrap() > 0.0, "{exponent}");
    }
    let written = std::fs::read(out.join("stiffness.json")).unwrap();
    assert_eq!(serde_json::from_slice::<Value>(&written).unwrap(), report);
    let picture = std::fs::read_to_string(out.join("stiffness.svg")).unwrap();
    std::fs::remove_dir_all(&out).unwrap();
    assert!(picture.contains("500 grains") && picture.contains("mean_spin") && picture.ends_with("</svg>\n"));
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
