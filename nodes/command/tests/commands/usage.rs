//! The binary on the command line: help, usage errors, exit codes.

use crate::{REFERENCE, grainlab, grainlab_in};
use std::process::{Command, Stdio};
use system_tests::process::Process;
use system_tests::wait::LIMIT;

#[test]
fn help_goes_to_stdout_and_lists_every_command_and_exit_code() {
    let commands = ["launch", "scene", "run", "bag", "analyze", "probe", "invert", "calibrate"];
    grainlab(&["--help"]).assert_code(0).assert_prints(&commands).assert_prints(&["130 interrupted"]);
    let nodes = ["dem_simulator", "look_around", "recorder"];
    let parameters = ["tolerance", "speed_noise", "modulus_error", "Examples"];
    grainlab(&["run", "--help"]).assert_prints(&nodes).assert_prints(&parameters);
}

#[test]
fn a_run_directory_that_no_parameter_can_hold_is_refused_with_the_cause_before_anything_starts() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    for (name, cause) in [(&b"a\nb"[..], "control character"), (b"a\xffb", "is not UTF-8")] {
        for flag in ["--run", "--out", "--resume"] {
            let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab"));
            command.args(["launch".as_ref(), flag.as_ref(), OsStr::from_bytes(name)]);
            Process::start(command.current_dir(folder.path()))
                .ended(LIMIT)
                .assert_code(2)
                .assert_says(&[cause, "choose another directory"]);
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        }
    }
}

#[test]
fn wrong_usage_ends_with_exit_code_2_and_names_what_is_wrong() {
    for (arguments, word) in [
        (&["lunch"][..], "lunch"),
        (&["run", "no_such_node"], "no_such_node"),
        (&["run", "grainlab", "no_such_node"], "no node \"no_such_node\""),
        (&["run", "foxglove_bridge"], "grainlab run packing_pictures"),
        (&["topic", "list", "-tv"], "topic list -v was removed"),
        (&["service", "list"], "all else: ros2 service"),
        (&["run", "dem_simulator", "scene:=demo"], "scene:=demo"),
        (&["run", "dem_simulator", "--ros-args", "-p", "scene"], "\"scene\""),
        (&["run", "fabric_analyzer", "--ros-args", "-p", "tolerence:=1e-8"], "tolerance"),
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
        grainlab(arguments).assert_code(2).assert_says(&[word]);
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
        grainlab(arguments).assert_code(1).assert_says(&["nowhere"]);
    }
}

#[test]
fn moduli_that_no_packing_has_end_with_exit_code_4() {
    let moduli = ["--g12=1e8", "--g13=3e8", "--theta=1e8", "--pressure=5e4", "--format=json"];
    let answer = grainlab(&[&["invert"], &moduli[..]].concat()).assert_code(4).json();
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
    let list = grainlab(&["scene", "list"]).stdout;
    let names: Vec<_> = list.lines().filter_map(|line| line.split_once("  ")).map(|(name, _)| name).collect();
    assert_eq!(
        names.iter().map(|n| n.trim()).collect::<Vec<_>>(),
        ["demo", "s1", "s2", "s3", "s4", "uniaxial", "literal", "rolling"]
    );
    let show = grainlab(&["scene", "show", "s3", "--set", "grains.count=500", "--seed", "7"]);
    let shown = show.stdout;
    for line in ["count = 500", "seed = 7", "friction = 0.3", "name = \"s3\"", "time_step_safety = 0.8"] {
        assert!(shown.lines().any(|l| l == line), "{line} is missing:\n{shown}");
    }
    let folder = tempfile::tempdir().unwrap();
    let here = |arguments: &[&str]| grainlab_in(folder.path(), arguments);
    std::fs::write(folder.path().join("shown.toml"), &shown).unwrap();
    assert_eq!(here(&["scene", "show", "shown.toml"]).stdout, shown, "what is shown can be run");
    assert_eq!(here(&["scene", "new", "mine"]).stdout, "mine.toml\n");
    assert_eq!(here(&["scene", "new", "mine"]).code, Some(1), "it is there already");
    assert_eq!(here(&["scene", "new", "yours", "--base", "mine.toml"]).code, Some(0));
    assert_eq!(here(&["scene", "new", "No Name"]).code, Some(2));
    std::fs::write(
        folder.path().join("bad.toml"),
        "base = 'mine.toml'\nname = 'bad'\nfriktion = 1\nseed = -1\n",
    )
    .unwrap();
    let check = here(&["scene", "check", "yours.toml", "bad.toml", "s1"]);
    check
        .assert_code(2)
        .assert_prints(&["yours.toml     500       4         1", "s1"])
        .assert_says(&["bad.toml: the scene has 2 faults", "did you mean friction?"]);
}

#[test]
fn a_packing_to_start_from_that_no_phase_would_call_at_rest_is_noted() {
    let folder = tempfile::tempdir().unwrap();
    let check = |limit: &str| {
        let path = folder.path().join("on.toml");
        let scene = format!(
            "name = 'on'\nfriction = 0.1\nstart.packing = '{REFERENCE}'\n[[phase]]\nkind = 'servo'\ncontrol.xx.stress = 1e5\n\
             until.unbalanced = {limit}\n"
        );
        std::fs::write(&path, scene).unwrap();
        grainlab(&["scene", "check", &path.to_string_lossy()]).assert_code(0).stdout
    };
    assert!(!check("1e-9").contains("do not balance"));
    let noted = check("1e-12");
    assert!(noted.contains("do not balance") && noted.contains("phases end at 1e-12 or less"), "{noted}");
}

#[test]
fn an_escape_sequence_in_a_name_is_shown_on_the_terminal_and_not_obeyed() {
    let output = grainlab(&["analyze", "no\x1b[31msuch.csv"]);
    let said = output.stderr;
    assert!(said.contains(r"no\u{1b}[31msuch.csv") && !said.contains('\x1b'), "{said:?}");
}

#[test]
fn a_directory_without_a_run_is_left_as_it_is_when_it_is_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let output = grainlab(&["launch", "--resume", &folder.path().to_string_lossy()]);
    assert_ne!(output.code, Some(0), "{}", output.stderr);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "a lock is left");
}
