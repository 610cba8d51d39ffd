//! `grainlab bench overview`: its report, not its speed.

use serde_json::Value;
use std::process::{Command, Stdio};

#[test]
fn every_family_has_finite_errors_which_fall_with_the_tolerance_and_all_are_in_table_and_figure() {
    let out = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab"));
    command.args(["bench", "overview", "--quick", "--format", "json", "--out"]).arg(out.path());
    let output = command.stdin(Stdio::null()).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = report["rows"].as_array().unwrap();
    let families = ["inversion_eps", "inversion_z", "stiffness", "engine_energy", "engine_packing", "waves"];
    for family in families {
        assert!(rows.iter().any(|r| r["family"] == family && r["on_front"] == true), "{family}");
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
    // The shorter of two time steps creates less energy.
    assert!(errors("engine_energy", "time step").is_sorted_by(|a, b| a < b), "{rows:?}");
    // The models of the paper take γ/Δ and have no scatter between packings; `relaxed` errs least.
    let eps = |method: &str| errors("inversion_eps", method)[0];
    assert!(eps("relaxed") < eps("directional") && eps("directional") < eps("ratio"), "{rows:?}");

    let stored = std::fs::read(out.path().join("overview.json")).unwrap();
    assert_eq!(stored, output.stdout, "the file is what was printed");
    let csv = std::fs::read_to_string(out.path().join("overview.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + rows.len());
    let svg = std::fs::read_to_string(out.path().join("overview.svg")).unwrap();
    assert!(svg.contains("engine, energy") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    // Each row has a point with its text; the legend has none.
    assert_eq!(svg.matches("<title>").count(), rows.len());
}
