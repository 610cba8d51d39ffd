//! The shipped launch files under the launch package of ROS 2.

use std::path::Path;
use std::process::Command;
use system_tests::bodies::{assert_same, distinct};
use system_tests::lab::{LIMIT, Lab, golden, grainlab};
use system_tests::process::Process;
use system_tests::python;

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
