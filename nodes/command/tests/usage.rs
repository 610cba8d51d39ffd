//! The binary on the command line: help, usage errors, exit codes.

use std::process::{Command, Output, Stdio};

fn grainlab(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab"));
    command.args(arguments).stdin(Stdio::null()).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn help_goes_to_stdout_and_lists_every_command_and_exit_code() {
    let help = grainlab(&["--help"]);
    assert_eq!(help.status.code(), Some(0));
    let out = text(&help.stdout);
    for word in [
        "launch",
        "scene",
        "run",
        "bag",
        "analyze",
        "probe",
        "invert",
        "calibrate",
        "bench",
        "130 interrupted",
    ] {
        assert!(out.contains(word), "{word} is missing:\n{out}");
    }
    let help = text(&grainlab(&["run", "--help"]).stdout);
    for word in
        ["dem_simulator", "look_around", "tolerance", "speed_noise", "modulus_error", "recorder", "Examples"]
    {
        assert!(help.contains(word), "{word} is missing:\n{help}");
    }
}

#[test]
fn wrong_usage_ends_with_exit_code_2_and_names_what_is_wrong() {
    for (arguments, word) in [
        (&["lunch"][..], "lunch"),
        (&["run", "no_such_node"], "no_such_node"),
        (&["run", "dem_simulator", "scene:=demo"], "scene:=demo"),
        (&["run", "dem_simulator", "--ros-args", "-p", "scene"], "\"scene\""),
        (&["launch", "--scene", "no-such-scene"], "demo, s1"),
        (&["launch", "--seed", "-3"], "-3"),
        (&["launch", "--set", "grains.cuont=500"], "grains.cuont: unknown key (did you mean count?)"),
        (&["launch", "--set", "grains.count=0"], "grains.count: is 0; it must be a whole number from 1"),
        (&["launch", "--set", "phase.rset.drag=1"], "did you mean rest?"),
        (&["launch", "--set", "friction"], "KEY=VALUE"),
        (&["run", "dem_simulator", "--ros-args", "-p", "set:=[friction=-1]"], "friction: is -1"),
        (&["invert", "--g12", "1e8"], "--pressure"),
        (&["invert", "--pressure", "5e4"], "G12"),
        (&["invert", "--table", "x.csv", "--g12", "1e8"], "--table"),
        (&["invert", "--pressure", "5e4", "--calibration", "x"], "paper"),
        (&["invert", "--table", "x.csv", "--by", "mu2"], "--judge"),
        (&["invert", "--pressure", "5e4", "--poisson", "0.7"], "--poisson 0.7"),
        (
            &[
                "invert",
                "--g12",
                "1e8",
                "--g13",
                "1e8",
                "--theta",
                "1e8",
                "--pressure",
                "5e4",
                "--model",
                "x",
            ],
            "ratio",
        ),
        (
            &["invert", "--g12=-1e8", "--g13", "1e8", "--theta", "1e8", "--pressure", "5e4"],
            "must be positive",
        ),
        (&["bag", "record", "--msg-path", "nowhere"], "nowhere"),
        (&["bag", "record", "--qos-profile-overrides-path", "nowhere.yaml"], "nowhere.yaml"),
        (&["bag", "record", "--topics", "packing_chunk"], "record packing"),
        (&["analyze", "x.csv", "--cell", "1,2"], "3 or 9"),
    ] {
        let output = grainlab(arguments);
        let err = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {err}");
        assert!(err.contains(word), "{word:?} is missing for {arguments:?}: {err}");
    }
}

#[test]
fn missing_files_end_with_exit_code_1_and_are_named() {
    for arguments in [
        &["analyze", "nowhere.csv"][..],
        &["bag", "info", "nowhere"],
        &["bag", "play", "nowhere"],
        &["launch", "nowhere/x.launch.yaml"],
        &["invert", "--table", "nowhere.csv"],
    ] {
        let output = grainlab(arguments);
        let err = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {err}");
        assert!(err.contains("nowhere"), "{arguments:?}: {err}");
    }
}

#[test]
fn moduli_that_no_packing_has_end_with_exit_code_4() {
    let output = grainlab(&[
        "invert",
        "--g12",
        "1e8",
        "--g13",
        "3e8",
        "--theta",
        "1e8",
        "--pressure",
        "5e4",
        "--format",
        "json",
    ]);
    assert_eq!(output.status.code(), Some(4));
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(answer["results"][0]["status"], "unknown");
    assert!(answer["results"][0]["k"].is_null());
}

#[test]
fn a_closed_pipe_is_not_an_error() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab"));
    command.args(["invert", "--g12", "1e8", "--g13", "1e8", "--theta", "1.3e8", "--pressure", "5e4"]);
    let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn scenes_are_listed_shown_checked_and_begun() {
    let list = text(&grainlab(&["scene", "list"]).stdout);
    let names: Vec<_> = list.lines().filter_map(|line| line.split_once("  ")).map(|(name, _)| name).collect();
    assert_eq!(
        names.iter().map(|n| n.trim()).collect::<Vec<_>>(),
        ["demo", "s1", "s2", "s3", "s4", "uniaxial", "literal", "rolling"]
    );
    let show = grainlab(&["scene", "show", "s3", "--set", "grains.count=500", "--seed", "7"]);
    let shown = text(&show.stdout);
    for line in ["count = 500", "seed = 7", "friction = 0.3", "name = \"s3\"", "time_step_safety = 0.8"] {
        assert!(shown.lines().any(|l| l == line), "{line} is missing:\n{shown}");
    }
    let folder = tempfile::tempdir().unwrap();
    let here = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab"));
        command.args(arguments).current_dir(folder.path()).stdin(Stdio::null()).output().unwrap()
    };
    std::fs::write(folder.path().join("shown.toml"), &shown).unwrap();
    assert_eq!(text(&here(&["scene", "show", "shown.toml"]).stdout), shown, "what is shown can be run");
    assert_eq!(text(&here(&["scene", "new", "mine"]).stdout), "mine.toml\n");
    assert_eq!(here(&["scene", "new", "mine"]).status.code(), Some(1), "it is there already");
    assert_eq!(here(&["scene", "new", "yours", "--base", "mine.toml"]).status.code(), Some(0));
    assert_eq!(here(&["scene", "new", "No Name"]).status.code(), Some(2));
    std::fs::write(
        folder.path().join("bad.toml"),
        "base = 'mine.toml'\nname = 'bad'\nfriktion = 1\nseed = -1\n",
    )
    .unwrap();
    let check = here(&["scene", "check", "yours.toml", "bad.toml", "s1"]);
    let (out, err) = (text(&check.stdout), text(&check.stderr));
    assert_eq!(check.status.code(), Some(2));
    assert!(out.contains("yours.toml     500       4         1") && out.contains("s1"), "{out}");
    assert!(
        err.contains("bad.toml: the scene has 2 faults") && err.contains("did you mean friction?"),
        "{err}"
    );
}

#[test]
fn a_packing_to_start_from_that_no_phase_would_call_at_rest_is_noted() {
    let folder = tempfile::tempdir().unwrap();
    let packing = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/golden/reference/ref_packing_500.csv.gz");
    let check = |limit: &str| {
        let path = folder.path().join("on.toml");
        let scene = format!(
            "name = 'on'\nfriction = 0.1\nstart.packing = '{packing}'\n[[phase]]\nkind = 'servo'\ncontrol.xx.stress = 1e5\n\
             until.unbalanced = {limit}\n"
        );
        std::fs::write(&path, scene).unwrap();
        let check = grainlab(&["scene", "check", &path.to_string_lossy()]);
        assert_eq!(check.status.code(), Some(0), "{}", text(&check.stderr));
        text(&check.stdout)
    };
    assert!(!check("1e-9").contains("do not balance"));
    let noted = check("1e-12");
    assert!(noted.contains("do not balance") && noted.contains("phases end at 1e-12 or less"), "{noted}");
}
