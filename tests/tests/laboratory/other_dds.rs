//! An independent DDS implementation, CycloneDDS from Python, that has only the message files in common with grainlab.

use grainlab_any_message::{Schema, Shown};
use grainlab_msgs::{TypeInfo, topics};
use grainlab_node_kit::{Bus, DdsBus, Names, Network};
use grainlab_recordings::{Recording, Selection};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use std::time::Duration;
use system_tests::lab::{LIMIT, Lab, golden, until};
use system_tests::process::{Ended, Process};
use system_tests::python;

fn tool(lab: &Lab, python: &Path, script: &str, arguments: &[&str]) -> Process {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools").join(script);
    Process::start(
        Command::new(python)
            .arg(script)
            .args(arguments)
            .env("ROS_DOMAIN_ID", lab.domain.to_string())
            .env_remove("CYCLONEDDS_URI"),
    )
}

fn json(ended: &Ended) -> Value {
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    serde_json::from_str(&ended.stdout).unwrap()
}

/// The recorded messages of a topic as JSON, decoded by the definition of their type.
fn recorded(run: &Path, topic: &str, info: &TypeInfo) -> Vec<Value> {
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
    let heard = json(&peer.ended(LIMIT));

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
        let all = recorded(&run, &from.absolute_name(), &topic.info);
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
    let scene = format!("scene:={}", golden("scenes/endless.toml").display());
    let simulator = lab.start(&["run", "dem_simulator", "--ros-args", "-p", &scene]);
    let counts = json(&tool(&lab, &python, "cyclone_peer.py", &["servo", "10000"]).ended(LIMIT));
    assert_eq!((counts["answered"].as_u64(), counts["missed"].as_u64()), (Some(10_000), Some(0)), "{counts}");
    assert!(counts["clocks"].as_u64() > Some(0), "{counts}");
    simulator.signal(libc::SIGINT);
    simulator.ended(LIMIT);
}

#[test]
fn a_client_on_another_dds_reads_describes_and_sets_parameters() {
    let Some(python) = python::with("cyclonedds") else { return };
    let lab = Lab::new();
    let node = lab.start(&["run", "emt_inversion"]);
    let ask = |arguments: &[&str]| json(&tool(&lab, &python, "parameter_client.py", arguments).ended(LIMIT));
    let names = ask(&["/emt_inversion", "list"]);
    assert!(names.as_array().unwrap().iter().any(|n| n == "gamma_over_delta"), "{names}");
    let described = ask(&["/emt_inversion", "describe", "use_sim_time"]);
    assert_eq!((described[0]["type"].as_u64(), described[0]["read_only"].as_bool()), (Some(1), Some(false)));
    assert_eq!(ask(&["/emt_inversion", "set", "use_sim_time", "true"])["successful"], true);
    assert_eq!(ask(&["/emt_inversion", "get", "use_sim_time"])["use_sim_time"], true);
    let refused = ask(&["/emt_inversion", "set", "models", "\"paper\""]);
    assert!(refused["reason"].as_str().unwrap().contains("read-only"), "{refused}");
    node.signal(libc::SIGINT);
    node.ended(LIMIT);
}
