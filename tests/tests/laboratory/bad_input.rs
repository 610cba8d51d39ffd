//! Invalid input of every kind: a clear message, the right exit code, no panic, no loss.

use std::process::Command;
use system_tests::lab::{Lab, grainlab, scene_path, undisturbed};
use system_tests::process::{Ended, Process};
use system_tests::wait::{LIMIT, until};

#[track_caller]
fn refused(lab: &Lab, arguments: &[&str], code: i32, words: &[&str]) -> Ended {
    let ended = lab.run(arguments).assert_code(code).assert_says(words);
    assert!(!ended.stderr.contains("panicked"), "{}", ended.stderr);
    ended
}

#[test]
fn a_truncated_recording_is_read_as_far_as_it_goes_with_exit_code_3() {
    let lab = Lab::new();
    let run = undisturbed(&[]);
    let name = format!("{}_0.mcap", run.file_name().unwrap().to_string_lossy());
    let bytes = std::fs::read(run.join(&name)).unwrap();
    // Summary, footer and the last chunks are missing; the packings precede them.
    std::fs::write(lab.folder().join("cut.mcap"), &bytes[..bytes.len() * 96 / 100]).unwrap();
    let states = refused(&lab, &["analyze", "cut.mcap", "--format", "json"], 3, &["cut.mcap"]).json();
    assert!(!states.as_array().unwrap().is_empty(), "what is readable is measured");
    refused(&lab, &["bag", "info", "cut.mcap"], 3, &["cut.mcap"]);
}

#[test]
fn by_hand_a_second_simulator_on_the_same_topic_is_refused() {
    let lab = Lab::new();
    let parameter = format!("scene:={}", scene_path("tiny"));
    let by_hand = ["run", "dem_simulator", "--ros-args", "-p", &parameter];
    // Both wait for a servo: the one with the larger GUID ends.
    let (mut first, mut second) = (lab.start(&by_hand), lab.start(&by_hand));
    until("one gives way", || !first.runs() || !second.runs());
    let (gone, stays) = if first.runs() { (second, first) } else { (first, second) };
    gone.ended(LIMIT).assert_code(1).assert_says(&["stress", "ROS_DOMAIN_ID"]);
    // The other one was waiting for a servo.
    stays.ended_by(libc::SIGINT).assert_code(130);
}

#[test]
fn a_refused_launch_leaves_no_folder() {
    let lab = Lab::new();
    let built_in = include_str!("../../../nodes/launch/demo.launch.yaml");
    let large = "#".repeat(2 << 20);
    for (name, text, code, word) in [
        ("empty.launch.yaml", "launch: []", 2, "does not declare the arg"),
        ("evil.launch.yaml", &built_in.replace("name: recorder", "name: ../../evil"), 2, "../../evil"),
        ("unknown.launch.yaml", &built_in.replace("run servo_controller", "run servo"), 2, "servo"),
        ("foreign.launch.yaml", &built_in.replace("grainlab run servo", "missing run servo"), 2, "missing"),
        ("large.launch.yaml", &large, 1, "1048576"),
    ] {
        lab.write(name, text);
        refused(&lab, &["launch", name], code, &[word]);
    }
    refused(&lab, &["launch", "no_such:=1"], 2, &["no_such"]);
    refused(&lab, &["launch", "/dev/zero"], 1, &["device"]);
    refused(&lab, &["launch", "--scene", "/dev/zero"], 1, &["device"]);
    assert!(!lab.folder().join("recordings").exists(), "a run was begun");
}

#[test]
fn paths_that_are_not_files_are_refused_at_once() {
    let lab = Lab::new();
    let pipe = lab.folder().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let pipe = pipe.to_string_lossy();
    for path in ["/dev/zero", &pipe] {
        let word = if path == "/dev/zero" { "device" } else { "pipe" };
        refused(&lab, &["analyze", path], 1, &[path, word]);
        for action in ["info", "check", "recover"] {
            refused(&lab, &["bag", action, path], 1, &[path, word]);
        }
    }
    refused(&lab, &["invert", "--table", "/dev/zero"], 1, &["/dev/zero", "device"]);
    let folder = lab.folder().to_string_lossy().into_owned();
    refused(&lab, &["invert", "--table", &folder], 1, &["directory"]);
}

#[test]
fn a_cell_a_billion_times_as_long_as_wide_is_measured_or_refused_in_little_memory() {
    let lab = Lab::new();
    for long in ["1e3", "1e9", "1e30"] {
        let mut text = format!(
            "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n5\nITEM: BOX BOUNDS pp pp pp\n0 {long}\n0 6e-3\n0 6e-3\n\
             ITEM: ATOMS id radius x y z\n"
        );
        (0..5).for_each(|k| text += &format!("{k} 1e-3 {} 1e-3 1e-3\n", 1.9e-3 * f64::from(k)));
        lab.write("long.dump", &text);
        let flags = ["--shear-modulus", "29e9", "--poisson", ".2", "--friction", ".1", "--density", "2500"];
        // The process needs a quarter of a gigabyte; an earlier search needed twenty.
        let limited = format!("ulimit -v 1500000; exec \"$0\" analyze long.dump {}", flags.join(" "));
        let mut bash = Command::new("bash");
        bash.args(["-c", &limited]).arg(grainlab()).current_dir(lab.folder());
        let ended = Process::start(&mut bash).ended(LIMIT);
        assert!(ended.code.is_some_and(|c| c <= 4), "{long}: {ended:?}");
        assert!(!ended.stderr.contains("panicked") && !ended.stderr.contains("allocation"), "{ended:?}");
    }
}
