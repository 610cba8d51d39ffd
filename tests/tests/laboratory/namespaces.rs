//! Launch files whose nodes are in a ROS namespace, or have other names for their topics.

use grainlab_msgs::topics::TOPICS;
use std::path::{Path, PathBuf};
use system_tests::bodies::{assert_same_named, assert_same_under};
use system_tests::lab::{LIMIT, Lab, golden};

const NODES: [&str; 5] =
    ["recorder", "emt_inversion", "fabric_analyzer", "servo_controller", "dem_simulator"];

/// The launch file of the demo with these ROS arguments for the nodes that `wanted` selects.
fn launch_file(lab: &Lab, name: &str, arguments: &str, wanted: impl Fn(&str) -> bool) -> PathBuf {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../nodes/launch/demo.launch.yaml");
    let mut text = std::fs::read_to_string(demo).unwrap();
    for node in NODES.iter().filter(|node| wanted(node)) {
        let (with, bare) = (format!("run {node} --ros-args"), format!("run {node}"));
        let given = format!("{bare} --ros-args {arguments}");
        let found = if text.contains(&with) { with } else { bare };
        text = text.replace(&found, &given);
    }
    let path = lab.folder().join(name);
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn a_launch_file_with_a_namespace_ends_and_gives_the_same_bytes() {
    let (plain, left) = (Lab::new(), Lab::new());
    let scene = golden("scenes/tiny.toml");
    let expected = plain.launch(&scene, &[]);
    let file = launch_file(&left, "left.launch.yaml", "-r __ns:=/left", |_| true);
    let run = left.launch(&scene, &[&file.to_string_lossy()]);
    assert_same_under(&expected, &run, "/left");
    // Whatever reads the recording finds its topics.
    let analyzed = left.run(&["analyze", &run.to_string_lossy()]);
    assert_eq!(analyzed.code, Some(0), "{}{}", analyzed.stdout, analyzed.stderr);
    let again = left.run(&["launch", "--resume", &run.to_string_lossy()]);
    assert!(again.code == Some(2) && again.stderr.contains("the run is finished"), "{}", again.stderr);
}

#[test]
fn a_launch_file_with_a_remap_of_every_topic_ends_and_gives_the_same_bytes() {
    let (plain, other) = (Lab::new(), Lab::new());
    let scene = golden("scenes/tiny.toml");
    let expected = plain.launch(&scene, &[]);
    let renamed = |name: &str| format!("/other/my_{}", name.trim_start_matches('/'));
    let rules: Vec<String> = TOPICS.iter().map(|t| format!("-r {}:={}", t.name, renamed(t.name))).collect();
    let file = launch_file(&other, "other.launch.yaml", &rules.join(" "), |_| true);
    let run = other.launch(&scene, &[&file.to_string_lossy()]);
    assert_same_named(&expected, &run, renamed);
    let text = std::fs::read_to_string(run.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(summary["states"].as_array().unwrap().len(), 2, "{text}");
    assert_eq!(summary["warnings"], serde_json::json!([]));
    assert!(summary["exchanges"].as_u64() > Some(0), "{text}");
}

#[test]
fn two_laboratories_in_two_namespaces_of_one_domain_give_the_same_bytes() {
    let (plain, lab) = (Lab::new(), Lab::new());
    let scene = golden("scenes/tiny.toml");
    let expected = plain.launch(&scene, &[]);
    let started = ["left", "right"].map(|side| {
        let file = launch_file(&lab, &format!("{side}.yaml"), &format!("-r __ns:=/{side}"), |_| true);
        let (file, scene) = (file.to_string_lossy().into_owned(), scene.to_string_lossy());
        (side, lab.start(&["launch", &file, "--scene", &scene, "--out", side]))
    });
    for (side, launcher) in started {
        let ended = launcher.ended(LIMIT);
        assert_eq!(ended.code, Some(0), "{side}\n{}\n{}", ended.stdout, ended.stderr);
        assert_same_under(&expected, &lab.folder().join(side).join("tiny-3-1"), &format!("/{side}"));
    }
}

#[test]
fn a_launch_file_whose_processes_would_not_meet_is_refused_before_anything_is_started() {
    let lab = Lab::new();
    let one = |node: &'static str| move |name: &str| name == node;
    for (node, rule, topic) in [
        ("servo_controller", "-r __ns:=/left", "stress"),
        ("emt_inversion", "-r microstructure:=/other", "microstructure"),
        ("recorder", "-r packing:=grains", "packing"),
    ] {
        let file = launch_file(&lab, "apart.launch.yaml", rule, one(node));
        let refused = lab.run(&["launch", &file.to_string_lossy()]);
        assert_eq!(refused.code, Some(2), "{}", refused.stderr);
        assert!(refused.stderr.contains(&format!("the topic {topic} is ")), "{}", refused.stderr);
        assert!(!lab.folder().join("recordings").exists());
    }
}
