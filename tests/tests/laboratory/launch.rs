//! `grainlab launch`: every node is a process, or all are in one; a table, a recording that other tools read, and launch files
//! whose topics have other names.

use grainlab_msgs::topics::TOPICS;
use grainlab_recordings::Recording;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use system_tests::bodies::{REPRODUCIBLE, assert_same, assert_same_named, distinct};
use system_tests::lab::{Lab, SLOW, grainlab, number, scene_path, summary, undisturbed};
use system_tests::process::{Process, children, runs, send};
use system_tests::python;
use system_tests::terminal::{Shown, Terminal};
use system_tests::wait::LIMIT;

const NODES: [&str; 5] =
    ["recorder", "emt_inversion", "fabric_analyzer", "servo_controller", "dem_simulator"];
const RECORDED: [&str; 9] = [
    "/stress",
    "/strain_rate",
    "/packing",
    "/packing_report",
    "/microstructure",
    "/run_state",
    "/clock",
    "/rosout",
    "/diagnostics",
];

#[test]
fn a_launch_runs_one_process_a_node_and_records_every_message() {
    let lab = Lab::new();
    let launcher = lab.start_launch("tiny", &["--verbose"]);
    let mut most: BTreeMap<&str, usize> = BTreeMap::new();
    let pid = launcher.pid();
    let watch = std::thread::spawn(move || {
        let begin = Instant::now();
        while begin.elapsed() < LIMIT && Path::new(&format!("/proc/{pid}/fd")).exists() {
            for node in NODES {
                let count = children(pid, &format!("run {node}")).len();
                most.entry(node).and_modify(|m| *m = count.max(*m)).or_insert(count);
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        most
    });
    let ended = launcher.ended(LIMIT).assert_code(0);
    assert_eq!(watch.join().unwrap(), NODES.map(|node| (node, 1)).into());
    ended
        .assert_prints(&["g12_pa", "G12", "theta_pa", "ratio", "eps_k", "recommended: relaxed"])
        .assert_says(&["gas", "rest", "uniaxial", "load", "settle"]);

    let run = lab.last_run();
    let summary = summary(&run);
    let topics = summary["topics"].as_array().unwrap();
    for name in RECORDED {
        let topic = topics.iter().find(|t| t["name"] == name);
        let topic = topic.unwrap_or_else(|| panic!("{name} is not in {topics:?}"));
        let count = |key: &str| topic[key].as_u64().unwrap();
        assert!(count("recorded") > 0 && count("lost") == 0, "{topic}");
        assert_eq!(count("published"), count("recorded") + count("repeated"), "{topic}");
    }
    let states = summary["states"].as_array().unwrap();
    assert_eq!(states.len(), 2, "the scene publishes two packings");
    let last = &states[1];
    // The servo brings every component to its target before the measurement.
    for (i, s) in last["stress_pa"].as_array().unwrap().iter().enumerate() {
        let target = if i < 3 { 50e3 } else { 0.0 };
        assert!((number(s) - target).abs() <= 50.0, "stress component {i} is {s}");
    }
    let [k, z, phi, g12, theta] = ["k", "z", "phi", "g12_pa", "theta_pa"].map(|key| number(&last[key]));
    assert!(k > 4.0 && z > k && phi > 0.6 && g12 > 5e7 && theta > g12, "{last}");
    let result = |model: &str| {
        let of_model = last["results"].as_array().unwrap().iter().find(|r| r["model"] == model);
        of_model.unwrap_or_else(|| panic!("no result of {model} in {last}"))
    };
    let (ratio, _) = (result("ratio"), result("ratio-as-printed"));
    assert_eq!((&ratio["source"], &ratio["calibration"]), (&json!("packing_report"), &json!("paper")));
    assert!(ratio["k"].is_f64() && ratio["z"].is_null() && ratio["sigma"]["k"].is_f64(), "{ratio}");
    assert!(ratio["degrees_of_freedom"] == 0 && ratio["condition_number"].is_f64(), "{ratio}");
    assert!(run.join("metadata.yaml").is_file());

    if let Some(python) = python::with("mcap_ros2, rosbags, zstandard, lz4, yaml") {
        let mut arguments = vec![run.to_str().unwrap(), "--require"];
        arguments.extend(RECORDED);
        let check = python::tool(&python, "check_mcap.py", &arguments);
        let (out, err) = (String::from_utf8_lossy(&check.stdout), String::from_utf8_lossy(&check.stderr));
        assert!(check.status.success(), "{out}\n{err}");
    }
}

#[test]
fn launches_without_a_domain_take_one_each_lose_nothing_and_print_one_screen() {
    let labs = [Lab::new(), Lab::new()];
    let start = |lab: &Lab| {
        let mut launch = lab.command(&["launch", "--scene", &scene_path("tiny")]);
        Process::start(launch.env_remove("ROS_DOMAIN_ID"))
    };
    for launcher in labs.each_ref().map(start) {
        let ended = launcher.ended(LIMIT).assert_code(0);
        assert!((5..=20).contains(&ended.stdout.lines().count()), "{}", ended.stdout);
        ended.assert_prints(&["G12", "est. k", "relaxed", "0 lost", "summary.json", "analyze"]);
    }
    let [a, b] = labs.each_ref().map(Lab::last_run);
    assert_ne!(summary(&a)["domain"], summary(&b)["domain"]);
    assert_same(&a, &b);
}

/// A phase has one line on a terminal, and no other line of the launch is left.
#[test]
fn an_interrupted_launch_ends_every_process_leaves_whole_lines_on_a_terminal_and_finishes_the_recording() {
    const COLUMNS: usize = 80;
    let lab = Lab::new();
    let (terminal, stderr) = Terminal::open(COLUMNS as u16);
    let mut command = lab.command(&["launch", "--scene", &scene_path("endless")]);
    let mut launcher = command.env("TERM", "xterm").stdout(Stdio::null()).stderr(stderr).spawn().unwrap();
    drop(command);
    lab.until_recorded(200);
    let nodes: Vec<u32> = NODES.iter().flat_map(|n| children(launcher.id(), &format!("run {n}"))).collect();
    assert_eq!(nodes.len(), NODES.len());
    send(launcher.id(), libc::SIGINT);
    assert_eq!(launcher.wait().unwrap().code(), Some(130));
    for pid in nodes {
        assert!(!runs(pid), "process {pid} is left behind");
    }
    let run = lab.last_run();
    let recording = Recording::open(&run).unwrap();
    assert_eq!(recording.warnings().len(), 0, "{:?}", recording.warnings());

    let Shown { lines, erased } = terminal.shown();
    assert!(erased.iter().any(|line| line.contains(" 1 of ")), "no live line was drawn: {erased:?}");
    let wide = |line: &&String| line.chars().count() > COLUMNS;
    assert_eq!(erased.iter().find(wide), None, "a live line is wider than the terminal");
    // Lines that are left: lines with the time that are about a phase that is over, or about the launch.
    let progress = lines.iter().filter(|line| line.starts_with('['));
    let left: Vec<_> = progress.filter(|l| l.contains(" of ") && !l.contains(" steps ")).collect();
    assert!(left.is_empty(), "a live line is left: {left:?}");
    assert_eq!(lines.last().map(String::as_str), Some(""), "the cursor is not in a line of its own");

    // No row of an interrupted run looks settled.
    let summary = summary(&run);
    assert_eq!(summary["states"].as_array().unwrap().len(), 0, "{}", summary["states"]);
    assert_eq!(summary["within_phases"]["packings"], 1);
    let states = lab.run(&["analyze", &run.to_string_lossy(), "--format", "json"]).json();
    let state = states.as_array().map_or(&states, |all| &all[0]);
    assert_eq!(state["end_of_phase"], false, "{state}");
    assert!(state["warnings"].to_string().contains("had not met its end conditions"), "{state}");
}

/// The folder of the launch files in this repository.
fn launch_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../nodes/launch")
}

#[test]
fn the_same_nodes_run_by_hand_and_from_a_launch_file() {
    let lab = Lab::new();
    let (script, scene) = (launch_folder().join("by_hand.sh"), scene_path("tiny"));
    let mut by_hand = Command::new("sh");
    by_hand
        .args([script.as_os_str(), scene.as_ref(), "3".as_ref(), "by_hand".as_ref()])
        .current_dir(lab.folder())
        .env("GRAINLAB", grainlab())
        .env("ROS_DOMAIN_ID", lab.domain.to_string());
    Process::start(&mut by_hand).ended(LIMIT).assert_code(0);
    assert_same(&undisturbed(&[]), &lab.folder().join("by_hand"));

    let file = launch_folder().join("demo.launch.yaml");
    let run = lab.launch(Path::new(&scene), &[&file.to_string_lossy(), "--seed", "3"]);
    assert_same(&undisturbed(&[]), &run);
}

#[test]
fn a_launch_file_with_a_remap_of_every_topic_ends_and_gives_the_same_bytes() {
    let lab = Lab::new();
    let renamed = |name: &str| format!("/other/my_{}", name.trim_start_matches('/'));
    let rules: Vec<String> = TOPICS.iter().map(|t| format!("-r {}:={}", t.name, renamed(t.name))).collect();
    let mut text = std::fs::read_to_string(launch_folder().join("demo.launch.yaml")).unwrap();
    for node in NODES {
        let (with, bare) = (format!("run {node} --ros-args"), format!("run {node}"));
        let found = if text.contains(&with) { with } else { bare.clone() };
        text = text.replace(&found, &format!("{bare} --ros-args {}", rules.join(" ")));
    }
    let file = lab.write("other.launch.yaml", &text);
    let run = lab.launch(Path::new(&scene_path("tiny")), &[&file.to_string_lossy()]);
    assert_same_named(&undisturbed(&[]), &run, renamed);
    let summary = summary(&run);
    assert_eq!(summary["states"].as_array().unwrap().len(), 2, "{summary}");
    assert_eq!(summary["warnings"], json!([]));
    assert!(summary["exchanges"].as_u64() > Some(0), "{summary}");
}

#[test]
fn one_process_records_the_bytes_of_many_and_says_so() {
    let lab = Lab::new();
    let launch = |how: &[&str]| {
        let acoustic = ["launch", "acoustic", "--scene", &scene_path("tiny")];
        lab.run(&[&acoustic[..], how].concat()).assert_code(0);
        lab.last_run()
    };
    let (many, one) = (launch(&[]), launch(&["--one-process"]));
    assert!(!distinct(&many, "/wave_speeds").is_empty() && !distinct(&many, "/clock").is_empty());
    for topic in REPRODUCIBLE.into_iter().chain(["/wave_speeds", "/clock"]) {
        assert!(distinct(&one, topic) == distinct(&many, topic), "{topic}");
    }
    for (run, transport) in [(&one, "memory"), (&many, "dds")] {
        let metadata = Recording::open(run).unwrap().metadata("grainlab").unwrap();
        assert_eq!(metadata.get("transport").map(String::as_str), Some(transport));
    }
    lab.run(&["bag", "check", &one.to_string_lossy()]).assert_code(0);
}

#[test]
fn results_alone_are_small_and_the_same() {
    let (whole, lab) = (undisturbed(&[]), Lab::new());
    let launch = |name: &str, how: &[&str]| {
        let flags = ["--record", "results", "--no-report", "--set", name];
        lab.launch(Path::new(&scene_path("tiny")), &[&flags[..], how].concat())
    };
    let run = launch("name='few'", &["--one-process"]);
    for topic in ["/packing_report", "/microstructure"] {
        assert!(distinct(&run, topic) == distinct(&whole, topic), "{topic}");
    }
    let channels = Recording::open(&run).unwrap().channels();
    assert!(channels.iter().all(|c| c.topic != "/stress") && !run.join("report.html").exists());
    for command in ["report", "analyze"] {
        lab.run(&[command, &run.to_string_lossy()]).assert_code(0);
    }
    let processes = launch("name='many'", &[]);
    assert!(distinct(&processes, "/packing_report") == distinct(&run, "/packing_report"));
}

/// Tools of the bus say meanwhile that a run is in one process.
#[test]
fn an_interrupted_or_killed_run_goes_on_in_one_process_to_the_same_bytes() {
    let expected = undisturbed(&SLOW);
    for (signal, code) in [(libc::SIGINT, Some(130)), (libc::SIGKILL, None)] {
        let lab = Lab::new();
        let launcher = lab.start_launch("tiny", &[&SLOW[..], &["--one-process"]].concat());
        lab.until_recorded(20);
        if code.is_some() {
            lab.run(&["topic", "list"]).assert_says(&["in one process, not on the bus"]);
        }
        let run = lab.last_run();
        let ended = launcher.ended_by(signal);
        assert_eq!(ended.code, code, "{}{}", ended.stdout, ended.stderr);
        lab.run(&["launch", "--resume", &run.to_string_lossy()]).assert_code(0);
        for topic in ["/stress", "/strain_rate"] {
            assert!(distinct(&run, topic) == distinct(&expected, topic), "{topic} after signal {signal}");
        }
        for topic in ["/packing_report", "/microstructure"] {
            assert_eq!(distinct(&run, topic).last(), distinct(&expected, topic).last(), "{topic} {signal}");
        }
    }
}

#[test]
fn a_node_that_fails_ends_the_run_with_its_name_and_a_program_is_refused() {
    let lab = Lab::new();
    let failing = ["--scene", "demo", "--set", "grains.count=100", "--set", "phase.rest.until.timeout=1e-6"];
    lab.run(&[&["launch", "--one-process"], &failing[..]].concat())
        .assert_code(4)
        .assert_says(&["dem_simulator ended with exit code 4: ", "(rest) did not meet its end conditions"]);
    let demo = std::fs::read_to_string(launch_folder().join("demo.launch.yaml")).unwrap();
    lab.write("own.launch.yaml", &(demo + "- executable:\n    cmd: sleep 1\n    name: instrument\n"));
    lab.run(&["launch", "own.launch.yaml", "--one-process"])
        .assert_code(2)
        .assert_says(&["instrument: one process has no other programs"]);
}

#[test]
fn a_program_that_fails_before_the_run_begins_ends_the_run_with_its_name() {
    let lab = Lab::new();
    let demo = std::fs::read_to_string(launch_folder().join("demo.launch.yaml")).unwrap();
    let servo = "grainlab run servo_controller --ros-args -p min_readers:=2";
    lab.write("failing.launch.yaml", &demo.replace(servo, "sh -c 'exit 7'").replace("respawn: \"true\"", ""));
    lab.run(&["launch", "failing.launch.yaml"])
        .assert_code(1)
        .assert_says(&["servo_controller ended with exit code 7 before the run began"]);
}

/// A directory keeps its finished run, and refuses another one.
#[test]
fn a_finished_run_is_not_run_again_and_reported_where_its_launcher_was_killed_before() {
    let lab = Lab::new();
    let launch = |seed: &str| lab.start_launch("tiny", &["--seed", seed, "--run", "mine"]).ended(LIMIT);
    launch("1").assert_code(0);
    let file = lab.folder().join("mine/summary.json");
    let summary = std::fs::read(&file).unwrap();
    launch("1").assert_code(0).assert_says(&["the run is finished"]);
    assert_eq!(std::fs::read(&file).unwrap(), summary);
    launch("2").assert_code(2).assert_says(&["another scene (line 3: `seed = "]);
    // A launcher that was killed after the run, before it reported it.
    std::fs::remove_file(&file).unwrap();
    launch("1").assert_code(0);
    let [old, new] = [summary, std::fs::read(&file).unwrap()]
        .map(|text| serde_json::from_slice::<serde_json::Value>(&text).unwrap()["states"].clone());
    assert_eq!(old, new);
}
