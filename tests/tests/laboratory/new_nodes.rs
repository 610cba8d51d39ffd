//! `grainlab new node`: what it writes works as it is, and the types for CycloneDDS can be installed.

use std::path::{Path, PathBuf};
use std::process::Command;
use system_tests::lab::{Lab, grainlab};
use system_tests::python;

/// Runs a command in a new node's folder, with the domain of the laboratory.
fn run(lab: &Lab, folder: &str, program: &Path, arguments: &[&str]) -> String {
    let mut command = Command::new(program);
    command.args(arguments).current_dir(lab.folder().join(folder));
    command.envs(lab.command(&[]).get_envs().filter_map(|(name, value)| Some((name, value?))));
    let target = grainlab().parent().and_then(Path::parent).unwrap().to_owned();
    let ended = command.env("GRAINLAB", grainlab()).env("CARGO_TARGET_DIR", target).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&ended.stdout), String::from_utf8_lossy(&ended.stderr));
    assert!(ended.status.success(), "{program:?} {arguments:?}\n{out}{err}");
    out.into_owned()
}

fn new(lab: &Lab, arguments: &[&str]) {
    let made = lab.run(&[&["new", "node"], arguments].concat());
    assert_eq!(made.code, Some(0), "{}{}", made.stdout, made.stderr);
}

#[test]
fn an_instrument_and_a_servo_in_python_pass_the_tests_that_are_written_with_them() {
    let Some(python) = python::with("cyclonedds, pytest") else { return };
    let lab = Lab::new();
    for (name, kind) in [("my_probe", "--python"), ("my_servo", "--servo")] {
        new(&lab, &[name, kind]);
        run(&lab, name, &python, &["-m", "pytest", "-q", "-p", "no:cacheprovider"]);
    }
    let again = lab.run(&["new", "node", "my_probe"]);
    assert!(again.code == Some(2) && again.stderr.contains("exists"), "{}", again.stderr);
    // The package of the types, installed beside nothing else.
    let install = ["-m", "pip", "install", "-q", "--no-deps", "--target", "../types", "./msgs"];
    run(&lab, "my_probe", &python, &install);
    let import = "import sys; sys.path.insert(0, 'types'); import grainlab_msgs as g; assert 'types' in g.__file__; \
                  print(g.message('grainlab_msgs/msg/Stress')().mode, g.message('sensor_msgs/msg/Imu')())";
    assert!(run(&lab, ".", &python, &["-c", import]).starts_with("[0, 0, 0, 0, 0, 0]"));
}

#[test]
fn a_node_in_rust_is_a_crate_of_its_own_that_builds_and_receives_its_answer() {
    let lab = Lab::new();
    new(&lab, &["my_node", "--rust"]);
    // The versions, the profile and so the built libraries of this workspace: a new build of all takes minutes.
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let (folder, read) =
        (lab.folder().join("my_node"), |path: PathBuf| std::fs::read_to_string(path).unwrap());
    std::fs::copy(top.join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    let workspace = read(top.join("Cargo.toml"));
    let profile = workspace.find("[profile.release]").map(|at| &workspace[at..]).unwrap();
    let profile: Vec<&str> = profile.lines().filter(|line| !line.starts_with("grainlab_")).collect();
    let manifest = read(folder.join("Cargo.toml")) + &profile.join("\n");
    std::fs::write(folder.join("Cargo.toml"), manifest).unwrap();
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let out = run(&lab, "my_node", Path::new(&cargo), &["test", "--release", "--offline"]);
    assert!(out.contains("the_inversion_answers ... ok"), "{out}");
}
