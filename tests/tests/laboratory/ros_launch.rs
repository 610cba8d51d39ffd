//! The shipped launch files under the launch package of ROS 2, and launch files of ROS 2's documentation here.

use std::path::Path;
use std::process::Command;
use system_tests::bodies::{assert_same, assert_same_under, distinct};
use system_tests::lab::{Lab, golden, grainlab, undisturbed};
use system_tests::process::Process;
use system_tests::python;
use system_tests::wait::{LIMIT, until};

/// A shipped launch file, with the scene `tiny`, by the launch package of ROS 2; the run is recorded to `name`.
fn launch(lab: &Lab, python: &Path, file: &str, name: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let binaries = grainlab().parent().unwrap().to_owned();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(std::iter::once(binaries).chain(std::env::split_paths(&path))).unwrap();
    let mut command = Command::new(python);
    command
        .arg(root.join("tools/ros_launch.py"))
        .arg(root.join("../nodes/launch").join(file))
        .args([
            format!("scene:={}", golden("scenes/tiny.toml").display()),
            format!("out:={name}"),
            "seed:=3".into(),
        ])
        .current_dir(lab.folder())
        .env("PATH", path)
        .env("ROS_DOMAIN_ID", lab.domain.to_string())
        .env("ROS_LOG_DIR", lab.folder().join("ros"))
        .env_remove("GRAINLAB_RUN");
    let ended = Process::start(&mut command).ended(LIMIT);
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    ended.stdout + &ended.stderr
}

#[test]
fn every_node_of_a_shipped_file_ends_by_itself_when_the_last_packing_is_inverted() {
    let Some(python) = python::with_ros("launch_yaml") else { return };
    for (file, name, nodes, inverted) in
        [("demo.launch.yaml", "demo", 5, 2), ("acoustic.launch.yaml", "acoustic", 6, 4)]
    {
        let lab = Lab::new();
        let output = launch(&lab, &python, file, name);
        assert_eq!(output.matches("process has finished cleanly").count(), nodes, "{output}");
        let recorded = lab.folder().join(name);
        assert_eq!(distinct(&recorded, "/microstructure").len(), inverted, "{output}");
        if name == "demo" {
            lab.launch(&golden("scenes/tiny.toml"), &["--seed", "3"]);
            assert_same(&recorded, &lab.last_run());
        }
    }
}

/// Ten launch files of the tutorials of ROS 2: number of processes, or the fault with its line.
#[test]
fn launch_files_of_the_documentation_of_ros_2_start_or_are_refused_with_line_and_reason() {
    let files: [(&str, Result<usize, [&str; 2]>); 10] = [
        ("mimic", Ok(3)),
        ("formats", Ok(7)),
        ("substitutions", Err(["line 18", "$(var NAME) and $(dirname) are supported"])),
        ("main_substitutions", Ok(1)),
        ("world_1", Ok(1)),
        ("world_2", Ok(1)),
        ("world_3", Ok(1)),
        ("broadcaster_listener", Ok(2)),
        ("large", Ok(6)),
        ("rviz", Err(["line 2", "rviz2"])),
    ];
    for (name, expected) in files {
        let lab = Lab::new();
        let file = golden(&format!("launch/{name}.launch.yaml"));
        let launched = lab.start(&["launch", file.to_str().unwrap()]);
        match expected {
            Ok(count) => {
                until(name, || lab.run(&["node", "list"]).stdout.lines().count() == count);
                launched.signal(libc::SIGINT);
                assert_eq!(launched.ended(LIMIT).code, Some(130), "{name}");
            }
            Err(needles) => {
                let ended = launched.ended(LIMIT);
                let is_named = needles.iter().all(|needle| ended.stderr.contains(needle));
                assert!(ended.code == Some(2) && is_named, "{name}: {}", ended.stderr);
            }
        }
    }
}

#[test]
fn a_launch_file_with_a_pushed_namespace_runs_two_laboratories_in_one_domain() {
    let lab = Lab::new();
    let [file, scene] = [golden("launch/labs.launch.yaml"), golden("scenes/tiny.toml")];
    let scene = format!("scene:={}", scene.display());
    let start = |name: &str| {
        let (lab_is, out) = (format!("lab:={name}"), format!("out:={name}"));
        lab.start(&["launch", file.to_str().unwrap(), &lab_is, &scene, &out])
    };
    let both = ["left", "right"].map(start);
    for process in both {
        let ended = process.ended(LIMIT);
        assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
    }
    for name in ["left", "right"] {
        let run = lab.folder().join(name).join("tiny-3-1");
        assert_same_under(&undisturbed(&[]), &run, &format!("/{name}"));
    }
    // Whatever reads the recording finds its topics.
    lab.run(&["analyze", "left/tiny-3-1"]).assert_code(0);
    lab.run(&["launch", "--resume", "left/tiny-3-1"]).assert_code(2).assert_says(&["the run is finished"]);
}
