//! Programs of other makers that have only the message files in common with grainlab: CycloneDDS from Python as a listener, a servo,
//! a client of parameters and an instrument, and the nodes that `grainlab new node` begins.

use grainlab_any_message::{Schema, Shown};
use grainlab_emt_inversion::{Settings, microstructure_of_speeds};
use grainlab_msgs::msg::{Estimate, Microstructure, WaveSpeeds};
use grainlab_msgs::{TypeInfo, topics};
use grainlab_node_kit::{Bus, DdsBus, Graph, Names, Network};
use grainlab_recordings::{Recording, Selection};
use grainlab_testkit::nightly;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;
use system_tests::bodies::decoded;
use system_tests::lab::{Lab, example, golden, grainlab, scene_path, summary};
use system_tests::process::Process;
use system_tests::python;
use system_tests::wait::{LIMIT, until};

fn here(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Starts a program of another maker in the folder and domain of the laboratory, on loopback.
fn start(lab: &Lab, command: &mut Command) -> Process {
    let plain = lab.command(&[]);
    for (name, value) in plain.get_envs() {
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
    }
    Process::start(command.current_dir(lab.folder()).env_remove("CYCLONEDDS_URI"))
}

/// Starts a script of `tests/tools`.
fn tool(lab: &Lab, python: &Path, script: &str, arguments: &[&str]) -> Process {
    start(lab, Command::new(python).arg(here("tools").join(script)).args(arguments))
}

fn json(process: Process) -> Value {
    process.ended(LIMIT).assert_code(0).json()
}

/// The recorded messages of a topic as JSON, decoded by the definition of their type.
fn recorded_json(run: &Path, topic: &str, info: &TypeInfo) -> Vec<Value> {
    let recording = Recording::open(run).unwrap();
    let schema = Schema::parse(info.type_name, info.definition).unwrap();
    let messages = recording.messages(&Selection::topics([topic])).unwrap();
    messages
        .map(|m| {
            let message = schema.decode(&m.payload).unwrap();
            serde_json::from_str(&Shown::new(&message).json()).unwrap()
        })
        .collect()
}

/// A line or report of the recorder: its last ones come after the end of the recording.
fn of_recorder(message: &Value) -> bool {
    message["name"] == "recorder" || message["status"][0]["name"] == "/recorder"
}

#[test]
fn another_dds_lists_the_nodes_and_reads_every_topic_field_by_field() {
    let Some(python) = python::with("cyclonedds") else { return };
    let lab = Lab::new();
    let sent_whole = topics::TOPICS.iter().filter(|t| !t.name.contains("packing_c"));
    let wanted: Vec<String> =
        sent_whole.map(|t| format!("{}={}", t.absolute_name(), t.info.type_name)).collect();
    let mut arguments = vec!["listen", "12"];
    arguments.extend(wanted.iter().map(String::as_str));
    let peer = tool(&lab, &python, "cyclone_peer.py", &arguments);
    let mut bus = DdsBus::open(Network::localhost(lab.domain), Names::new("early").unwrap()).unwrap();
    let stress = bus.advertise(&topics::STRESS).unwrap();
    until("the listener listens", || {
        bus.wait(Duration::from_millis(50));
        bus.readers(stress) > 0
    });
    drop(bus);
    let run = lab.launch(&golden("scenes/tiny.toml"), &[]);
    let heard = json(peer);

    let nodes: BTreeSet<&str> = heard["nodes"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    for node in ["/dem_simulator", "/servo_controller", "/fabric_analyzer", "/emt_inversion", "/recorder"] {
        assert!(nodes.contains(node), "{node} in {nodes:?}");
    }
    for topic in topics::TOPICS {
        let name = topic.absolute_name();
        if *topic == topics::PACKING_SAMPLED {
            continue;
        }
        let Some(messages) = heard["topics"][&name].as_array() else { continue };
        // A sample is one of the requests.
        let from = if *topic == topics::STRESS_SAMPLED { topics::STRESS } else { *topic };
        let all = recorded_json(&run, &from.absolute_name(), &topic.info);
        assert!(!messages.is_empty() || all.is_empty(), "nothing of {name} was received");
        for message in messages.iter().filter(|m| !of_recorder(m)) {
            assert!(all.contains(message), "{name}: received and not recorded: {message}");
        }
    }
}

#[test]
fn a_servo_on_another_dds_answers_ten_thousand_stresses_without_a_miss() {
    let Some(python) = python::with("cyclonedds") else { return };
    let lab = Lab::new();
    let scene = format!("scene:={}", scene_path("endless"));
    let simulator = lab.start(&["run", "dem_simulator", "--ros-args", "-p", &scene]);
    let counts = json(tool(&lab, &python, "cyclone_peer.py", &["servo", "10000"]));
    assert_eq!((counts["answered"].as_u64(), counts["missed"].as_u64()), (Some(10_000), Some(0)), "{counts}");
    assert!(counts["clocks"].as_u64() > Some(0), "{counts}");
    simulator.ended_by(libc::SIGINT);
}

#[test]
fn a_client_on_another_dds_reads_describes_and_sets_parameters() {
    let Some(python) = python::with("cyclonedds") else { return };
    let lab = Lab::new();
    let node = lab.start(&["run", "emt_inversion"]);
    let ask = |arguments: &[&str]| json(tool(&lab, &python, "parameter_client.py", arguments));
    let names = ask(&["/emt_inversion", "list"]);
    assert!(names.as_array().unwrap().iter().any(|n| n == "gamma_over_delta"), "{names}");
    let described = ask(&["/emt_inversion", "describe", "use_sim_time"]);
    assert_eq!((described[0]["type"].as_u64(), described[0]["read_only"].as_bool()), (Some(1), Some(false)));
    assert_eq!(ask(&["/emt_inversion", "set", "use_sim_time", "true"])["successful"], true);
    assert_eq!(ask(&["/emt_inversion", "get", "use_sim_time"])["use_sim_time"], true);
    let refused = ask(&["/emt_inversion", "set", "models", "\"paper\""]);
    assert!(refused["reason"].as_str().unwrap().contains("read-only"), "{refused}");
    node.ended_by(libc::SIGINT);
}

/// The answer of the inversion to a message that the instrument has sent.
fn expected(sent: &Value) -> Microstructure {
    let sent: WaveSpeeds =
        serde_json::from_value(sent.clone()).expect("the fields of our message, all of them");
    assert!(sent.speeds.len() >= 5 && sent.density > 0.0, "{sent:?}");
    microstructure_of_speeds(&sent, &Settings::default()).message
}

fn received(message: &Value) -> Microstructure {
    serde_json::from_value(message.clone()).expect("the fields of our message, all of them")
}

#[test]
fn an_instrument_of_another_vendor_receives_every_digit_of_its_microstructure() {
    let Some(python) = python::with("cyclonedds") else { return };
    let lab = Lab::new();
    let script = here("../nodes/launch/instrument.sh");
    let run = |arguments: &[&str]| {
        let mut command = Command::new("sh");
        command.arg(&script).args(arguments).env("GRAINLAB", grainlab()).env("PYTHON", &python);
        start(&lab, &mut command).ended(LIMIT).assert_code(0)
    };
    let whole = run(&["--json"]).json();
    let answer = received(&whole["received"]);
    assert_eq!(answer, expected(&whole["sent"]));
    assert_eq!((answer.source.as_str(), answer.estimates.len()), ("wave_speeds", emt_models()));
    // As text, one line per model, with the same numbers.
    let printed = run(&[]).stdout;
    for estimate in &answer.estimates {
        let line = printed.lines().find(|l| l.split_whitespace().next() == Some(&estimate.model));
        let line = line.unwrap_or_else(|| panic!("no line of {}:\n{printed}", estimate.model));
        for value in estimate.k.iter().chain(&estimate.z) {
            assert!(line.contains(&format!("{value:.4} +- ")), "{line}");
        }
    }
}

#[test]
fn an_instrument_of_another_vendor_that_a_launch_file_lists_is_of_the_run_and_recorded() {
    let Some(python) = python::with("cyclonedds") else { return };
    let lab = Lab::new();
    // The run begins when this program, which has its answer, reads packings too.
    let folder = here("../nodes/launch");
    let text = format!(
        "import sys; sys.path.insert(0, {folder:?})\nimport instrument as i\ni.main()\n\
         kind = i.message('grainlab_msgs/msg/Packing')\n\
         packings = i.reader(i.participant(), 'packing', kind, i.LATCHED)\n\
         while not packings.take(): i.time.sleep(0.01)\n"
    );
    let program = lab.write("listed.py", &text);
    let program = format!("{} {}", python.display(), program.display());
    let listed = format!("- executable:\n    cmd: {program}\n    name: instrument\n    output: screen\n");
    let demo = include_str!("../../../nodes/launch/demo.launch.yaml");
    let demo =
        demo.replace(" min_readers:=2 -p finish", " min_readers:=2 -p min_packing_readers:=3 -p finish");
    assert!(demo.contains("min_packing_readers"));
    lab.write("plugged.launch.yaml", &(demo + &listed));
    let folder = lab.launch(&golden("scenes/tiny.toml"), &["plugged.launch.yaml"]);
    assert_eq!(summary(&folder)["strangers"], serde_json::json!([]));
    let sent: Vec<WaveSpeeds> = decoded(&folder, "/wave_speeds");
    let answers: Vec<Microstructure> = decoded(&folder, "/microstructure");
    let answers: Vec<_> = answers.into_iter().filter(|m| m.source == "wave_speeds").collect();
    assert_eq!((sent.len(), answers.len()), (1, 1));
    assert_eq!(answers[0], microstructure_of_speeds(&sent[0], &Settings::default()).message);
}

#[test]
fn records_that_are_written_into_a_folder_are_picked_and_inverted_when_a_state_is_complete() {
    let Some(python) = python::with("cyclonedds") else { return };
    let lab = Lab::new();
    let _node = lab.start(&["run", "emt_inversion"]);
    let (from, folder) = (here("golden/beads"), lab.folder().join("records"));
    std::fs::create_dir(&folder).unwrap();
    let late = "p90-250kPa.csv";
    for file in std::fs::read_dir(&from).unwrap().map(|f| f.unwrap().file_name()) {
        if file != late {
            std::fs::copy(from.join(&file), folder.join(&file)).unwrap();
        }
    }
    let script = here("../nodes/launch/record_instrument.py");
    let mut command = Command::new(&python);
    command.arg(&script).arg(&folder).args(["--grain-shear-modulus", "29e9", "--poisson", "0.2", "--once"]);
    let writer = std::thread::spawn(move || {
        std::thread::sleep(std::time::Duration::from_secs(5));
        std::fs::copy(from.join(late), folder.join(late)).unwrap();
    });
    let ended = start(&lab, command.env("GRAINLAB", grainlab())).ended(LIMIT).assert_code(0);
    writer.join().unwrap();
    let states: Vec<&str> = ended.stdout.lines().filter(|l| l.starts_with("beads ")).collect();
    assert_eq!(states, ["beads 50e3 Pa", "beads 250e3 Pa"], "{}", ended.stdout);
    let estimates = ended.stdout.lines().filter(|l| l.starts_with("free-contact") && l.ends_with("ok"));
    assert_eq!(estimates.count(), 2, "{}", ended.stdout);
}

fn emt_models() -> usize {
    Settings::default().models.len()
}

#[test]
fn every_message_of_an_instrument_gets_its_own_answer_and_an_invalid_one_the_reason() {
    let Some(python) = python::with("cyclonedds") else { return };
    let lab = Lab::new();
    let mut node = lab.start(&["run", "emt_inversion"]);
    let said = json(tool(&lab, &python, "bad_instrument.py", &[]));
    // The third instrument comes when the first two are answered, and does not take their answers for its own.
    for case in ["good", "nameless", "other"] {
        assert_eq!(received(&said[case]["received"]), expected(&said[case]["sent"]), "{case}");
    }
    assert_eq!(said["nameless"]["sent"]["axis"]["z"], 0.0);
    assert_ne!(said["other"]["received"]["estimates"], said["nameless"]["received"]["estimates"]);
    let reasons = [
        "WaveSpeeds.speeds[2].speed = NaN is refused",
        "WaveSpeeds.density = -1498.0 is refused",
        "WaveSpeeds.|axis| = 2.0 is refused",
        "WaveSpeeds.speeds[0].method = 250 is refused",
        "WaveSpeeds.header.stamp.nanosec = 4294967295.0 is refused",
    ];
    let bad = said["bad"].as_array().unwrap();
    assert_eq!(bad.len(), reasons.len());
    for (bad, reason) in bad.iter().zip(reasons) {
        let answer = received(&bad["received"]);
        assert_eq!(answer.name, bad["name"].as_str().unwrap());
        assert_eq!(answer.estimates.len(), emt_models());
        for e in &answer.estimates {
            assert!(e.status == Estimate::STATUS_UNKNOWN && e.warnings[0].starts_with(reason), "{e:?}");
        }
    }
    assert_eq!(said["refused"], 7);
    assert_eq!(said["again"]["estimates"], said["good"]["received"]["estimates"], "the node lives on");
    assert!(node.runs());
    let node = node.ended_by(libc::SIGINT).assert_code(0).assert_says(&reasons);
    let node = node.assert_says(&["refused: grainlab_msgs/msg/WaveSpeeds: "]);
    assert!(!node.stderr.contains("panicked"), "{}", node.stderr);
}

/// Runs a command in a new node's folder, with the domain of the laboratory.
fn run_in(lab: &Lab, folder: &str, program: &Path, arguments: &[&str]) -> String {
    let mut command = Command::new(program);
    command.args(arguments).current_dir(lab.folder().join(folder));
    command.envs(lab.command(&[]).get_envs().filter_map(|(name, value)| Some((name, value?))));
    let target = grainlab().parent().and_then(Path::parent).unwrap().to_owned();
    command.env("GRAINLAB", grainlab()).env("CARGO_TARGET_DIR", target);
    Process::start(&mut command).ended(10 * LIMIT).assert_code(0).stdout
}

fn new(lab: &Lab, arguments: &[&str]) {
    lab.run(&[&["new", "node"], arguments].concat()).assert_code(0);
}

#[test]
fn an_instrument_and_a_servo_in_python_pass_the_tests_that_are_written_with_them() {
    let Some(python) = python::with("cyclonedds, pytest") else { return };
    let lab = Lab::new();
    for (name, kind) in [("my_probe", "--python"), ("my_servo", "--servo")] {
        new(&lab, &[name, kind]);
        run_in(&lab, name, &python, &["-m", "pytest", "-q", "-p", "no:cacheprovider"]);
    }
    lab.run(&["new", "node", "my_probe"]).assert_code(2).assert_says(&["exists"]);
    // The package of the types, installed beside nothing else.
    let install = ["-m", "pip", "install", "-q", "--no-deps", "--target", "../types", "./msgs"];
    run_in(&lab, "my_probe", &python, &install);
    let import = "import sys; sys.path.insert(0, 'types'); import grainlab_msgs as g; assert 'types' in g.__file__; \
                  print(g.message('grainlab_msgs/msg/Stress')().mode, g.message('sensor_msgs/msg/Imu')())";
    assert!(run_in(&lab, ".", &python, &["-c", import]).starts_with("[0, 0, 0, 0, 0, 0]"));
}

/// A build of the new crate with the features that it alone needs takes minutes of processor time: nightly.
#[test]
fn a_node_in_rust_is_a_crate_of_its_own_that_builds_and_receives_its_answer() {
    let lab = Lab::new();
    new(&lab, &["my_node", "--rust"]);
    let folder = lab.folder().join("my_node");
    let lock = Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.lock");
    std::fs::copy(lock, folder.join("Cargo.lock")).unwrap();
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let cargo = |arguments: &[&str]| run_in(&lab, "my_node", Path::new(&cargo), arguments);
    if nightly(false, true) {
        let out = cargo(&["test", "--release", "--offline"]);
        assert!(out.contains("the_inversion_answers ... ok"), "{out}");
        return;
    }
    // Packages of other platforms need not have been downloaded.
    let version = cargo(&["-vV"]);
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    let metadata = cargo(&["metadata", "--offline", "--format-version", "1", "--filter-platform", host]);
    assert!(metadata.contains("\"name\":\"my_node\""));
    // The program of the crate is that of the example but for the name.
    let file = folder.join("my_node.launch.yaml");
    let launch = std::fs::read_to_string(&file).unwrap();
    let run = "cargo run --quiet --release --manifest-path $(dirname)/Cargo.toml";
    assert_eq!(launch.matches(run).count(), 1, "{launch}");
    std::fs::write(&file, launch.replace(run, example("instrument").to_str().unwrap())).unwrap();
    let out = lab.run(&["launch", "my_node/my_node.launch.yaml"]).assert_code(0).stdout;
    assert!(out.contains("relaxed"), "{out}");
}
