//! Python: the module `grainlab`, built as `pip install` builds it, with its own tests on a run of ours, and the message files in
//! independent libraries.

use std::path::Path;
use std::process::Command;

use system_tests::lab::Lab;
use system_tests::python;

/// Packages that build the module, and those of its tests.
const NEEDED: &str =
    "maturin, numpy, pytest, nbclient, ipykernel, freud, ovito, arviz, arviz_base, matplotlib, pandas";

#[test]
fn the_python_module_installs_and_its_tests_pass_on_a_recorded_run() {
    let Some(python) = python::with(NEEDED) else { return };
    let lab = Lab::new();
    lab.run(&["launch", "--scene", "demo", "--set", "grains.count=150"]).assert_code(0);

    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap();
    let site = lab.folder().join("site");
    // pip finds the program maturin beside this Python.
    let mut path = python.parent().unwrap().as_os_str().to_owned();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    let install = ["-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation", "--target"];
    let installed = Command::new(&python)
        .args(install)
        .args([&site, &top.join("nodes/studio/python")])
        .env("PATH", &path)
        .output()
        .unwrap();
    assert!(installed.status.success(), "{}", String::from_utf8_lossy(&installed.stderr));

    let tested = Command::new(&python)
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider"])
        .arg(top.join("nodes/studio/python/tests"))
        .env("PATH", &path)
        .env("PYTHONPATH", &site)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("GRAINLAB_RECORDING", lab.last_run())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&tested.stdout);
    assert!(tested.status.success(), "{text}{}", String::from_utf8_lossy(&tested.stderr));
    assert!(text.contains(" passed") && !text.contains("skipped"), "{text}");
}

#[test]
fn message_files_parse_and_hash_alike_in_independent_libraries() {
    let Some(python) = python::with("mcap_ros2, rosbags") else { return };
    let msgs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../msgs");
    let (ours, standard) = (msgs.join("msg"), msgs.join("std"));
    let arguments = [ours.to_str().unwrap(), "--package", "grainlab_msgs", standard.to_str().unwrap()];
    let check = python::tool(&python, "check_msgs.py", &arguments);
    let out = String::from_utf8_lossy(&check.stdout);
    assert!(check.status.success(), "{out}\n{}", String::from_utf8_lossy(&check.stderr));
    let mut checked = 0;
    for line in out.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let (name, hash) = (words[0], words[words.len() - 1]);
        let info =
            grainlab_msgs::TypeInfo::by_name(name).unwrap_or_else(|| panic!("{name} is not generated"));
        assert_eq!(info.hash, hash, "{name}");
        checked += 1;
    }
    assert!(checked >= 12, "{checked} types checked:\n{out}");
}
