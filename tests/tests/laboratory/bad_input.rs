//! Invalid input of every kind: a clear message, the right exit code, no panic, no loss.

use system_tests::lab::{LIMIT, Lab, golden, until};
use system_tests::process::Ended;

fn refused(lab: &Lab, arguments: &[&str], code: i32, words: &[&str]) -> Ended {
    let ended = lab.run(arguments);
    assert_eq!(ended.code, Some(code), "{arguments:?}\n{}\n{}", ended.stdout, ended.stderr);
    for word in words {
        assert!(
            ended.stderr.contains(word),
            "{word:?} is missing from the message of {arguments:?}:\n{}",
            ended.stderr
        );
    }
    assert!(!ended.stderr.contains("panicked"), "{}", ended.stderr);
    ended
}

/// The small scene with one text replaced.
fn scene(lab: &Lab, from: &str, to: &str) -> String {
    let text = std::fs::read_to_string(golden("scenes/tiny.toml")).unwrap();
    assert!(text.contains(from));
    let path = lab.folder().join("bad.toml");
    std::fs::write(&path, text.replace(from, to)).unwrap();
    path.to_string_lossy().into_owned()
}

#[test]
fn faults_of_a_scene_end_with_exit_code_2() {
    let lab = Lab::new();
    let path = scene(&lab, "name = \"rest\"", "name = \"rest\"\nfriktion = 0.1");
    refused(&lab, &["launch", "--scene", &path], 2, &["friktion", "unknown key", "phase[1]"]);
    let path = scene(&lab, "friction = 10.0", "friction = -0.5");
    refused(&lab, &["launch", "--scene", &path], 2, &["friction", "-0.5", "0 or more"]);
    refused(&lab, &["launch", "--scene", "no-such-scene"], 2, &["no-such-scene", "demo"]);
}

#[test]
fn unknown_parameters_and_commands_end_with_exit_code_2() {
    let lab = Lab::new();
    let unknown = ["run", "fabric_analyzer", "--ros-args", "-p", "tolerence:=1e-8"];
    refused(&lab, &unknown, 2, &["tolerence", "tolerance"]);
    refused(&lab, &["run", "no_such_node"], 2, &["no_such_node", "dem_simulator"]);
    refused(&lab, &["invert", "--g12", "1e8"], 2, &["--pressure"]);
    refused(&lab, &["analyse-this"], 2, &[]);
    let reference = golden("reference/ref_packing_500.csv.gz");
    let reference = reference.to_string_lossy();
    for flag in [
        "--shear-modulus=0",
        "--shear-modulus=NaN",
        "--poisson=0.9",
        "--density=-1",
        "--friction=-0.5",
        "--amplitude=0",
        "--amplitude=0.1",
    ] {
        let name = flag.split('=').next().unwrap_or(flag);
        refused(&lab, &["analyze", &reference, flag], 2, &[name, "out of range"]);
    }
}

#[test]
fn missing_and_foreign_files_end_with_exit_code_1() {
    let lab = Lab::new();
    refused(&lab, &["analyze", "nowhere.mcap"], 1, &["nowhere.mcap"]);
    refused(&lab, &["bag", "info", "nowhere"], 1, &["nowhere"]);
    let path = lab.folder().join("text.mcap");
    std::fs::write(&path, "not a recording").unwrap();
    refused(&lab, &["bag", "info", &path.to_string_lossy()], 1, &["text.mcap"]);
}

#[test]
fn a_truncated_recording_is_read_as_far_as_it_goes_with_exit_code_3() {
    let lab = Lab::new();
    let run = lab.launch(&golden("scenes/tiny.toml"), &[]);
    let name = format!("{}_0.mcap", run.file_name().unwrap().to_string_lossy());
    let bytes = std::fs::read(run.join(&name)).unwrap();
    let cut = lab.folder().join("cut.mcap");
    // Summary, footer and the last chunks are missing; the packings precede them.
    std::fs::write(&cut, &bytes[..bytes.len() * 96 / 100]).unwrap();
    let cut = cut.to_string_lossy();
    let ended = refused(&lab, &["analyze", &cut, "--format", "json"], 3, &["cut.mcap"]);
    let states: serde_json::Value = serde_json::from_str(&ended.stdout).unwrap();
    assert!(!states.as_array().unwrap().is_empty(), "what is readable is measured");
    refused(&lab, &["bag", "info", &cut], 3, &["cut.mcap"]);
}

#[test]
fn by_hand_a_second_simulator_on_the_same_topic_is_refused() {
    let lab = Lab::new();
    let parameter = format!("scene:={}", golden("scenes/tiny.toml").display());
    let by_hand = ["run", "dem_simulator", "--ros-args", "-p", &parameter];
    // Both wait for a servo: the one with the larger GUID ends.
    let (mut first, mut second) = (lab.start(&by_hand), lab.start(&by_hand));
    until("one gives way", || !first.runs() || !second.runs());
    let (gone, stays) = if first.runs() { (second, first) } else { (first, second) };
    let ended = gone.ended(LIMIT);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("stress") && ended.stderr.contains("ROS_DOMAIN_ID"), "{}", ended.stderr);
    stays.signal(libc::SIGINT);
    assert_eq!(stays.ended(LIMIT).code, Some(130), "the other one was waiting for a servo");
}

#[test]
fn a_refused_launch_leaves_no_folder() {
    let lab = Lab::new();
    let file = |name: &str, text: &str| {
        let path = lab.folder().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_string_lossy().into_owned()
    };
    let built_in = include_str!("../../../nodes/launch/demo.launch.yaml");
    let large = "#".repeat(2 << 20);
    for (name, text, code, word) in [
        ("empty.launch.yaml", "launch: []", 2, "does not declare the arg"),
        ("evil.launch.yaml", &built_in.replace("name: recorder", "name: ../../evil"), 2, "../../evil"),
        ("unknown.launch.yaml", &built_in.replace("run servo_controller", "run servo"), 2, "servo"),
        ("foreign.launch.yaml", &built_in.replace("grainlab run servo", "missing run servo"), 2, "missing"),
        ("large.launch.yaml", &large, 1, "1048576"),
    ] {
        let path = file(name, text);
        refused(&lab, &["launch", &path], code, &[word]);
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
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let pipe = pipe.to_string_lossy();
    for path in ["/dev/zero", &pipe] {
        let word = if path == "/dev/zero" { "device" } else { "pipe" };
        refused(&lab, &["analyze", path], 1, &[path, word]);
        refused(&lab, &["bag", "info", path], 1, &[path, word]);
        refused(&lab, &["bag", "check", path], 1, &[path, word]);
        refused(&lab, &["bag", "recover", path], 1, &[path, word]);
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
        let path = lab.folder().join("long.dump");
        std::fs::write(&path, text).unwrap();
        let path = path.to_string_lossy();
        let flags = ["--shear-modulus", "29e9", "--poisson", ".2", "--friction", ".1", "--density", "2500"];
        // The process needs a quarter of a gigabyte; an earlier search needed twenty.
        let limited = format!("ulimit -v 1500000; exec \"$0\" analyze {path} {}", flags.join(" "));
        let output = std::process::Command::new("bash")
            .args(["-c", &limited])
            .arg(system_tests::lab::grainlab())
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code().is_some_and(|c| c <= 4), "{long}: {:?} {stderr}", output.status);
        assert!(!stderr.contains("panicked") && !stderr.contains("allocation"), "{long}: {stderr}");
    }
}
