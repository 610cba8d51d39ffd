//! `grainlab analyze` of many files: order, invalid files, interruption.

use serde_json::Value;
use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Command, Stdio};

fn reference() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden/reference/ref_packing_500.csv.gz")
}

fn analyze() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab"));
    command.arg("analyze").stdin(Stdio::null());
    command
}

/// A pair of grains `apart` in a unit cell, as a dump with one frame per step.
fn dump(apart: f64, steps: &[u64]) -> String {
    let frame = |step: &u64| {
        format!(
            "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 1\n0 1\n0 1\n\
             ITEM: ATOMS id x y z radius\n1 0.1 0 0 0.1\n2 {} 0 0 0.1\n",
            0.1 + apart
        )
    };
    steps.iter().map(frame).collect()
}

const GLASS: [&str; 8] =
    ["--shear-modulus", "29e9", "--poisson", "0.2", "--density", "2500", "--friction", "0.3"];

#[test]
fn one_bad_file_of_ten_loses_none_of_the_others_and_sets_the_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let mut names = Vec::new();
    for k in 0..10u64 {
        let path = folder.path().join(format!("{k}.dump"));
        let text = dump(0.19, &[100 * k, 100 * k + 1, 100 * k + 2]);
        // The invalid one ends in the middle of its second frame: its first one counts.
        let text = if k == 4 { text[..text.len() / 2].to_owned() } else { text };
        std::fs::write(&path, text).unwrap();
        names.push(path);
    }
    let out = analyze().args(&names).args(GLASS).args(["--format", "json"]).output().unwrap();
    let err = String::from_utf8_lossy(&out.stderr).into_owned();
    // Two grains have no network; a file that cannot be read has the worse exit code.
    assert_eq!(out.status.code(), Some(1), "{err}");
    assert!(err.contains("4.dump: line ") && err.lines().count() == 1, "{err}");
    let states: Value = serde_json::from_slice(&out.stdout).unwrap();
    let steps: Vec<u64> = states.as_array().unwrap().iter().map(|s| s["step"].as_u64().unwrap()).collect();
    let expected =
        (0..10).flat_map(|k| if k == 4 { vec![400] } else { vec![100 * k, 100 * k + 1, 100 * k + 2] });
    assert_eq!(steps, expected.collect::<Vec<_>>(), "in the order given");
}

#[test]
fn missing_properties_of_a_file_are_listed_and_the_exit_code_is_that_of_usage() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    std::fs::write(&path, "#format x_y_z_r\n0.1\t0\t0\t0.1\n0.29\t0\t0\t0.1\n").unwrap();
    let out = analyze().arg(&path).output().unwrap();
    let err = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(2), "{err}");
    for word in ["a.txt", "--cell", "--shear-modulus", "--friction"] {
        assert!(err.contains(word), "{err}");
    }
    let out = analyze().arg(&path).args(GLASS).args(["--cell", "1,1,1"]).output().unwrap();
    assert_eq!(out.status.code(), Some(4), "two grains have no network");
    assert!(String::from_utf8_lossy(&out.stdout).contains("2 grains, 1 contact, 2 rattlers"));
}

#[test]
fn negative_numbers_reach_the_flags_that_refuse_them() {
    for (flag, value) in [("--friction", "-1"), ("--shear-modulus", "-2e9"), ("--tolerance", "-0.5")] {
        let out = analyze().args(["x.csv", flag, value]).output().unwrap();
        let err = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{err}");
        assert!(err.contains(flag) && err.contains("out of range"), "{err}");
    }
}

#[test]
fn the_script_for_yade_is_printed() {
    let out = analyze().arg("--yade-script").output().unwrap();
    assert_eq!(out.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&out.stdout).contains("def export(name)"));
}

#[test]
fn a_recording_that_exists_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    for code in [0, 1] {
        let ended = analyze().arg(reference()).arg("--record").arg(&out).output().unwrap();
        assert_eq!(ended.status.code(), Some(code), "{}", String::from_utf8_lossy(&ended.stderr));
    }
}

#[test]
fn an_interrupted_analysis_prints_what_it_has() {
    const FILES: usize = 300;
    let mut command = analyze();
    command.args(vec![reference(); FILES]).args(["--format", "json"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut out = BufReader::new(child.stdout.take().unwrap());
    let mut text = String::new();
    // The first result: long before the last.
    while !text.contains("\"step\"") {
        assert_ne!(out.read_line(&mut text).unwrap(), 0, "{text}");
    }
    // SAFETY: kill takes two integers and accesses no memory of this process.
    unsafe { libc::kill(child.id() as i32, libc::SIGINT) };
    out.read_to_string(&mut text).unwrap();
    let ended = child.wait_with_output().unwrap();
    let err = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert_eq!(ended.status.code(), Some(130), "{err}");
    let states: Value = serde_json::from_str(&text).unwrap();
    let count = states.as_array().unwrap().len();
    assert!((1..FILES).contains(&count), "{count}");
    assert!(err.contains(&format!("interrupted: {count} packing")), "{err}");
}

/// Moduli, and whether they are those of smooth grains, of 500 grains without friction.
fn of_smooth_grains(command: &str, flags: &[&str]) -> Value {
    let file =
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden/packings/smooth_500.csv.gz");
    let mut grainlab = Command::new(env!("CARGO_BIN_EXE_grainlab"));
    let out = grainlab.arg(command).arg(file).args(flags).args(["--format", "json"]).output().unwrap();
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    let mut states: Value = serde_json::from_slice(&out.stdout).unwrap();
    let state = states[0].take();
    serde_json::json!([state["smooth"], state["stiffness_pa"], state["theta_bound_pa"], state["g12_pa"]])
}

#[test]
fn grains_without_friction_have_no_tangential_springs_in_analyze_and_probe_unless_asked_for() {
    let smooth = of_smooth_grains("analyze", &[]);
    assert_eq!(smooth[0], true);
    assert_eq!(smooth, of_smooth_grains("analyze", &["--smooth"]));
    assert_eq!(smooth, of_smooth_grains("analyze", &["--springs", "normal"]));
    assert_eq!(smooth, of_smooth_grains("probe", &["--survey", "three"]));
    let both = of_smooth_grains("analyze", &["--springs", "both"]);
    assert_eq!(both[0], false);
    assert!(both[3].as_f64() > Some(2.0 * smooth[3].as_f64().unwrap()), "{both} {smooth}");
}

#[test]
fn warnings_that_a_table_has_no_column_for_are_printed_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pair.dump");
    std::fs::write(&path, dump(0.19, &[7])).unwrap();
    let output = analyze().arg(&path).args(GLASS).args(["--format", "csv"]).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("pair.dump, step 7: contacts were found from positions"), "{said}");
}

#[test]
fn flags_that_change_nothing_are_refused_with_what_they_need() {
    for (flags, word) in [
        (&["--amplitude", "1e-6"][..], "--method probe"),
        (&["--method", "probe", "--tolerance", "1e-8"], "another --method"),
        (&["--topic", "nothing"], "recordings"),
    ] {
        let out = analyze().arg(reference()).args(flags).output().unwrap();
        let err = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(out.status.code() == Some(2) && err.contains(word), "{flags:?}: {err}");
    }
}
