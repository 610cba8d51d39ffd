//! The default command: every node is a process, with a table and a recording that other tools read.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use system_tests::bodies::assert_same;
use system_tests::lab::{LIMIT, Lab, golden, grainlab};
use system_tests::process::{Process, children, send};
use system_tests::python;
use system_tests::terminal::{Shown, Terminal};

const NODES: [&str; 5] =
    ["dem_simulator", "servo_controller", "fabric_analyzer", "emt_inversion", "recorder"];
const TOPICS: [&str; 9] = [
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

fn summary(run: &std::path::Path) -> Value {
    let path = run.join("summary.json");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_launch_runs_one_process_a_node_and_records_every_message() {
    let lab = Lab::new();
    let scene = golden("scenes/tiny.toml");
    let launcher = lab.start(&["launch", "--verbose", "--scene", &scene.to_string_lossy()]);
    let mut most: BTreeMap<&str, usize> = BTreeMap::new();
    let pid = launcher.pid();
    let watch = std::thread::spawn(move || {
        let begin = Instant::now();
        while begin.elapsed() < LIMIT && std::path::Path::new(&format!("/proc/{pid}/fd")).exists() {
            for node in NODES {
                let count = children(pid, &format!("run {node}")).len();
                most.entry(node).and_modify(|m| *m = count.max(*m)).or_insert(count);
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        most
    });
    let ended = launcher.ended(LIMIT);
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    let most = watch.join().unwrap();
    for node in NODES {
        assert_eq!(most.get(node), Some(&1), "processes of {node}");
    }
    for word in ["g12_pa", "G12", "theta_pa", "ratio", "eps_k", "recommended: relaxed"] {
        assert!(ended.stdout.contains(word), "{word} is missing from the table:\n{}", ended.stdout);
    }
    for phase in ["gas", "rest", "uniaxial", "load", "settle"] {
        assert!(ended.stderr.contains(phase), "no progress line of {phase}:\n{}", ended.stderr);
    }

    let run = lab.last_run();
    let summary = summary(&run);
    let topics = summary["topics"].as_array().unwrap();
    for name in TOPICS {
        let topic = topics
            .iter()
            .find(|t| t["name"] == name)
            .unwrap_or_else(|| panic!("{name} is not in {topics:?}"));
        assert!(topic["recorded"].as_u64().unwrap() > 0, "{topic}");
        assert_eq!(topic["lost"], 0, "{topic}");
        let count = |key: &str| topic[key].as_u64().unwrap();
        assert_eq!(count("published"), count("recorded") + count("repeated"), "{topic}");
    }
    let states = summary["states"].as_array().unwrap();
    assert_eq!(states.len(), 2, "the scene publishes two packings");
    let last = &states[1];
    let number = |key: &str| last[key].as_f64().unwrap_or_else(|| panic!("{key} in {last}"));
    // The servo brings every component to its target before the measurement.
    for (i, s) in last["stress_pa"].as_array().unwrap().iter().enumerate() {
        let target = if i < 3 { 50e3 } else { 0.0 };
        assert!((s.as_f64().unwrap() - target).abs() <= 50.0, "stress component {i} is {s}");
    }
    assert!(number("k") > 4.0 && number("z") > number("k") && number("phi") > 0.6);
    assert!(number("g12_pa") > 5e7 && number("theta_pa") > number("g12_pa"));
    let results = last["results"].as_array().unwrap();
    assert!(
        results.iter().any(|r| r["model"] == "ratio")
            && results.iter().any(|r| r["model"] == "ratio-as-printed")
    );
    let ratio = results.iter().find(|r| r["model"] == "ratio").unwrap();
    assert_eq!(
        (&ratio["source"], &ratio["calibration"]),
        (&"packing_report".into(), &"paper".into()),
        "{ratio}"
    );
    assert!(ratio["k"].is_f64() && ratio["z"].is_null() && ratio["sigma"]["k"].is_f64(), "{ratio}");
    assert!(ratio["degrees_of_freedom"] == 0 && ratio["condition_number"].is_f64(), "{ratio}");
    assert!(run.join("metadata.yaml").is_file());

    if let Some(python) = python::with("mcap_ros2, rosbags, zstandard, lz4, yaml") {
        let mut arguments = vec![run.to_str().unwrap(), "--require"];
        arguments.extend(TOPICS);
        let check = python::tool(&python, "check_mcap.py", &arguments);
        let (out, err) = (String::from_utf8_lossy(&check.stdout), String::from_utf8_lossy(&check.stderr));
        assert!(check.status.success(), "{out}\n{err}");
    }
}

#[test]
fn launches_without_a_domain_take_one_each_lose_nothing_and_print_one_screen() {
    let labs = [Lab::new(), Lab::new()];
    let scene = golden("scenes/tiny.toml");
    let start = |lab: &Lab| {
        let mut launch = lab.command(&["launch", "--scene", &scene.to_string_lossy()]);
        Process::start(launch.env_remove("ROS_DOMAIN_ID"))
    };
    let launchers = labs.each_ref().map(start);
    for launcher in launchers {
        let ended = launcher.ended(LIMIT);
        assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
        assert!((5..=20).contains(&ended.stdout.lines().count()), "{}", ended.stdout);
        for word in ["G12", "est. k", "relaxed", "0 lost", "summary.json", "analyze"] {
            assert!(ended.stdout.contains(word), "{word} is missing from:\n{}", ended.stdout);
        }
    }
    let [a, b] = labs.each_ref().map(Lab::last_run);
    assert_ne!(summary(&a)["domain"], summary(&b)["domain"]);
    assert_same(&a, &b);
}

#[test]
fn an_interrupted_launch_ends_every_process_and_finishes_the_recording() {
    let lab = Lab::new();
    let launcher: Process =
        lab.start(&["launch", "--scene", &golden("scenes/endless.toml").to_string_lossy()]);
    let pid = launcher.pid();
    lab.until_recorded(200);
    let nodes: Vec<u32> = NODES.iter().flat_map(|n| children(pid, &format!("run {n}"))).collect();
    assert_eq!(nodes.len(), NODES.len());
    launcher.signal(libc::SIGINT);
    let ended = launcher.ended(LIMIT);
    assert_eq!(ended.code, Some(130), "{}\n{}", ended.stdout, ended.stderr);
    for pid in nodes {
        assert!(!std::path::Path::new(&format!("/proc/{pid}/exe")).exists(), "process {pid} is left behind");
    }
    let recording = grainlab_recordings::Recording::open(&lab.last_run()).unwrap();
    assert_eq!(recording.warnings().len(), 0, "{:?}", recording.warnings());
}

#[test]
fn on_a_terminal_a_phase_has_one_line_and_an_interrupted_launch_leaves_no_other() {
    const COLUMNS: usize = 80;
    let lab = Lab::new();
    let (terminal, stderr) = Terminal::open(COLUMNS as u16);
    let scene = golden("scenes/endless.toml");
    let mut command = lab.command(&["launch", "--scene", &scene.to_string_lossy()]);
    let mut launcher = command.env("TERM", "xterm").stdout(Stdio::null()).stderr(stderr).spawn().unwrap();
    drop(command);
    lab.until_recorded(200);
    send(launcher.id(), libc::SIGINT);
    assert_eq!(launcher.wait().unwrap().code(), Some(130));
    let Shown { lines, erased } = terminal.shown();
    assert!(erased.iter().any(|line| line.contains(" 1 of ")), "no live line was drawn: {erased:?}");
    let wide = |line: &&String| line.chars().count() > COLUMNS;
    assert_eq!(erased.iter().find(wide), None, "a live line is wider than the terminal");
    // Lines that are left: lines with the time that are about a phase that is over, or about the launch.
    let progress = lines.iter().filter(|line| line.starts_with('['));
    let left: Vec<_> = progress.filter(|l| l.contains(" of ") && !l.contains(" steps ")).collect();
    assert!(left.is_empty(), "a live line is left: {left:?}");
    assert_eq!(lines.last().map(String::as_str), Some(""), "the cursor is not in a line of its own");
}

#[test]
fn the_same_nodes_run_by_hand_and_from_a_launch_file() {
    let lab = Lab::new();
    let launch = Path::new(env!("CARGO_MANIFEST_DIR")).join("../nodes/launch");
    let scene = golden("scenes/tiny.toml");
    let mut by_hand = Command::new("sh");
    by_hand
        .arg(launch.join("by_hand.sh"))
        .args([scene.as_os_str(), "3".as_ref(), "by_hand".as_ref()])
        .current_dir(lab.folder())
        .env("GRAINLAB", grainlab())
        .env("ROS_DOMAIN_ID", lab.domain.to_string());
    let ended = Process::start(&mut by_hand).ended(LIMIT);
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);

    let file = launch.join("demo.launch.yaml");
    let run =
        lab.run(&["launch", &file.to_string_lossy(), "--scene", &scene.to_string_lossy(), "--seed", "3"]);
    assert_eq!(run.code, Some(0), "{}\n{}", run.stdout, run.stderr);
    assert_same(&lab.folder().join("by_hand"), &lab.last_run());
}
