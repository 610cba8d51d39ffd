//! `grainlab_bench overview`: its report, not its speed.

use grainlab_testkit::nightly;
use serde_json::Value;
use std::process::{Command, Output, Stdio};

fn overview(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab_bench"));
    command.args(["overview"]).args(arguments).stdin(Stdio::null()).output().unwrap()
}

#[test]
fn every_family_has_finite_errors_which_fall_with_the_tolerance_and_all_are_in_table_and_figure() {
    let out = tempfile::tempdir().unwrap();
    // The engine takes a minute.
    let parts = nightly("inversion,stiffness,waves", "inversion,stiffness,waves,engine");
    let folder = out.path().to_str().unwrap();
    let engine = ["--settings", "skin", "--seeds", "2"];
    let output =
        overview(&[&["--quick", "--format", "json", "--out", folder, "--only", parts], &engine[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = report["rows"].as_array().unwrap();
    let families = ["inversion_eps", "inversion_z", "stiffness", "waves", "engine_energy", "engine_packing"];
    for family in &families[..nightly(4, 6)] {
        assert!(rows.iter().any(|r| r["family"] == *family && r["on_front"] == true), "{family}");
    }
    for row in rows {
        assert!(row["seconds"].as_f64().unwrap() > 0.0 && row["repetitions"].as_u64().unwrap() > 0, "{row}");
        assert!(row["error"].as_f64().unwrap() > 0.0, "{row}");
        assert!(
            ["error_of", "time_of", "reference"].iter().all(|k| row[k].as_str().unwrap().len() > 4),
            "{row}"
        );
    }
    let errors = |family: &str, method: &str| -> Vec<f64> {
        let of = rows.iter().filter(|r| r["family"] == family && r["method"] == method);
        of.map(|r| r["error"].as_f64().unwrap()).collect()
    };
    // A residual of 1e-2 to 1e-8; below, rounding is left.
    let solves = errors("stiffness", "cg");
    assert!(solves.len() > 3 && solves[..4].is_sorted_by(|a, b| a > b), "{solves:?}");
    // The models of the paper take γ/Δ and have no scatter between packings; `relaxed` errs least.
    let eps = |method: &str| errors("inversion_eps", method)[0];
    assert!(eps("relaxed") < eps("directional") && eps("directional") < eps("ratio"), "{rows:?}");

    let stored = std::fs::read(out.path().join("overview.json")).unwrap();
    assert_eq!(stored, output.stdout, "the file is what was printed");
    let csv = std::fs::read_to_string(out.path().join("overview.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + rows.len());
    let svg = std::fs::read_to_string(out.path().join("overview.svg")).unwrap();
    assert!(svg.contains("stiffness") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    // Each row has a point with its text; the legend has none.
    assert_eq!(svg.matches("<title>").count(), rows.len());
    if nightly(false, true) {
        // The shorter of two time steps creates less energy.
        assert!(errors("engine_energy", "time step").is_sorted_by(|a, b| a < b), "{rows:?}");
        the_skin_changes_nothing_and_other_changes_have_a_standard_error(rows);
    }
}

fn the_skin_changes_nothing_and_other_changes_have_a_standard_error(rows: &[Value]) {
    let rows: Vec<&Value> = rows.iter().filter(|r| r["family"] == "engine_packing").collect();
    // Results do not depend on neighbour lists: observables are equal to the last bit at every seed.
    let [default, other] = rows[..] else { panic!("{rows:?}") };
    assert_ne!(default["setting"], other["setting"]);
    assert_eq!(default["error"], other["error"]);
    let mut resolved = true;
    for name in ["k", "eps", "phi", "g12", "theta"] {
        let of = |row: &Value, key: &str| row[&format!("{key}_{name}")].as_f64().unwrap();
        assert_eq!(of(default, "error"), of(other, "error"), "{name}");
        assert!(of(default, "standard_error") > 0.0, "{name}");
        // Two seeds leave one degree of freedom: the interval is 12.7 standard errors.
        resolved &= of(default, "error").abs() >= 12.706 * of(default, "standard_error");
    }
    assert_eq!(default["upper_bound"], !resolved);
}

#[test]
fn wrong_usage_of_the_bench_is_refused_before_anything_is_run() {
    for (arguments, word) in [
        (&["--settings", "friction"][..], "strain_rate"),
        (&["--seeds", "1"], "2..=10000"),
        (&["--only", "servo"], "engine"),
    ] {
        let output = overview(arguments);
        let err = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {err}");
        assert!(err.contains(word), "{word:?} is missing for {arguments:?}: {err}");
    }
}
