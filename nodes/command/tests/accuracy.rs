//! `grainlab bench accuracy` on a scene of some seconds.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn accuracy(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab"));
    command.args(["bench", "accuracy"]).args(arguments).stdin(Stdio::null()).output().unwrap()
}

/// The tiny scene with half of its grains, in a separate folder.
fn scene(name: &str) -> (PathBuf, String) {
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden/scenes/tiny.toml");
    let text = std::fs::read_to_string(golden).unwrap();
    assert!(text.contains("count = 80"), "the scene has changed");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("tiny.toml");
    std::fs::write(&path, text.replace("count = 80", "count = 40")).unwrap();
    (folder, path.to_string_lossy().into_owned())
}

fn row<'a>(report: &'a Value, knob: &str, default: bool) -> &'a Value {
    let rows = report["rows"].as_array().unwrap();
    rows.iter().find(|r| r["knob"] == knob && r["default"] == default).unwrap()
}

#[test]
fn the_skin_changes_nothing_and_other_changes_have_a_standard_error() {
    let (folder, scene) = scene("accuracy");
    let out = folder.join("out");
    let out = out.to_string_lossy();
    let arguments =
        ["--quick", "--scene", &scene, "--knobs", "skin,time_step", "--out", &out, "--format", "json"];
    let output = accuracy(&arguments);
    let err = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{err}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["rows"].as_array().unwrap().len(), 4);

    // Results do not depend on neighbour lists: observables are equal to the last bit at every seed.
    let skin = row(&report, "skin", false);
    let default = row(&report, "skin", true);
    for name in ["k", "eps", "phi", "g12", "theta"] {
        assert_eq!(skin["change"][name], 0.0, "{name}");
        assert_eq!(skin["change_standard_error"][name], 0.0, "{name}");
        assert_eq!(skin["error"][name], default["error"][name], "{name}");
        assert!(default["standard_error"][name].as_f64().unwrap() > 0.0, "{name}");
    }
    assert_eq!(skin["steps"], default["steps"]);

    // A longer time step gives another packing in fewer steps.
    let long = row(&report, "time_step", false);
    assert!(long["value"].as_f64().unwrap() > row(&report, "time_step", true)["value"].as_f64().unwrap());
    assert!(long["change_standard_error"]["eps"].as_f64().unwrap() > 0.0);
    for r in report["rows"].as_array().unwrap() {
        assert!(r["seconds"].as_f64().unwrap() > 0.0 && r["combined"].as_f64().unwrap() > 0.0, "{r}");
        for name in ["k", "eps", "phi", "g12", "theta"] {
            let (mean, error) = (&r["error"][name], &r["standard_error"][name]);
            let (mean, error) = (mean.as_f64().unwrap(), error.as_f64().unwrap());
            // Two seeds leave one degree of freedom: the interval is 12.7 standard errors.
            assert_eq!(r["resolved"][name], mean.abs() >= 12.706 * error, "{r}");
        }
    }
    assert!(report["rows"].as_array().unwrap().iter().any(|r| r["on_front"] == true));
    assert!(report["verdict"][0].as_str().unwrap().starts_with("default: "));

    let stored = std::fs::read(folder.join("out/accuracy.json")).unwrap();
    assert_eq!(stored, output.stdout, "the file is what was printed");
    let svg = std::fs::read_to_string(folder.join("out/accuracy.svg")).unwrap();
    assert!(
        svg.starts_with("<svg") && svg.ends_with("</svg>\n") && svg.contains("default (skin = 0.05"),
        "{svg}"
    );
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}

#[test]
fn wrong_usage_of_the_bench_is_refused_before_anything_is_run() {
    for (arguments, word) in [
        (&["--knobs", "friction"][..], "strain_rate"),
        (&["--seeds", "1"], "2..=10000"),
        (&["--scene", "no-such-scene"], "demo, s1"),
    ] {
        let output = accuracy(arguments);
        let err = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {err}");
        assert!(err.contains(word), "{word:?} is missing for {arguments:?}: {err}");
    }
}

#[test]
fn a_scene_that_fails_as_it_stands_gives_no_numbers_and_exit_code_4() {
    let (folder, scene) = scene("accuracy-fails");
    let text = std::fs::read_to_string(&scene).unwrap();
    let path = folder.join("late.toml");
    // The relaxation cannot end within a microsecond.
    std::fs::write(&path, text.replace("timeout = 0.02", "timeout = 1.0e-6")).unwrap();
    let output = accuracy(&["--quick", "--knobs", "skin", "--scene", &path.to_string_lossy()]);
    let err = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{err}");
    assert!(output.stdout.is_empty() && err.contains("rest"), "{err}");
}
