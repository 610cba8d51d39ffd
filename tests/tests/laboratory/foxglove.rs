//! The bridge to viewers beside a run, with clients that are not ours.

use serde_json::Value;
use std::collections::BTreeSet;
use std::net::{Ipv4Addr, TcpListener};
use std::path::Path;
use std::process::{Command, Stdio};
use system_tests::lab::{LIMIT, Lab, golden};
use system_tests::process::Process;
use system_tests::python;

const MODULES: &str = "websockets, mcap_ros2";

/// Latched, streamed, standard, and made in the bridge.
const WANTED: [&str; 7] = [
    "/packing",
    "/packing/points",
    "/packing/markers",
    "/stress",
    "/packing_report",
    "/microstructure",
    "/tf_static",
];

fn free_port() -> String {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    listener.local_addr().unwrap().port().to_string()
}

fn client(python: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(python);
    command.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/foxglove_client.py")).args(arguments);
    command
}

#[test]
fn viewers_get_the_bytes_of_the_run_while_another_one_has_stopped_reading() {
    let Some(python) = python::with(MODULES) else { return };
    let lab = Lab::new();
    let port = free_port();
    let bridge = lab.start(&["run", "foxglove_bridge", "--ros-args", "-p", &format!("port:={port}")]);
    let (run, pictured) = (lab.folder().join("run"), lab.folder().join("pictured.mcap"));
    let (run, pictured) = (run.to_str().unwrap(), pictured.to_str().unwrap());
    let reader = |topics: &[&str]| {
        let arguments = [&["read", &port, "2", run, pictured], topics].concat();
        Process::start(&mut client(&python, &arguments))
    };
    let (all, few) = (reader(&WANTED), reader(&["/packing/points"]));
    let mut stalled =
        client(&python, &["stall", &port]).stdin(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();

    let recording = lab.launch(&golden("scenes/tiny.toml"), &[]);
    let made = lab.run(&["bag", "convert", recording.to_str().unwrap(), "--pictures", "-o", pictured]);
    assert_eq!(made.code, Some(0), "{}{}", made.stdout, made.stderr);
    std::fs::rename(&recording, run).unwrap();
    let found = |process: Process| -> Value {
        let ended = process.ended(LIMIT);
        assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
        serde_json::from_str(&ended.stdout).unwrap()
    };
    let (all, few) = (found(all), found(few));
    for topic in WANTED {
        assert!(all["counts"][topic].as_u64() > Some(0), "nothing of {topic}: {all}");
    }
    assert_eq!(all["counts"]["/packing"], all["counts"]["/packing/points"], "a picture for each packing");
    let topics: Vec<&String> = few["counts"].as_object().unwrap().keys().collect();
    assert_eq!(topics, ["/packing/points"], "only what was asked for");
    let advertised: BTreeSet<&str> =
        all["advertised"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(advertised.contains("/strain_rate") && !advertised.contains("/packing_chunk"), "{advertised:?}");

    drop(stalled.stdin.take());
    let _ = stalled.wait();
    bridge.signal(libc::SIGINT);
    let ended = bridge.ended(LIMIT);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(!ended.stderr.contains("WARN"), "{}", ended.stderr);
}

#[test]
fn a_port_in_use_and_an_address_that_is_none_are_named() {
    let lab = Lab::new();
    let taken = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let port = format!("port:={}", taken.local_addr().unwrap().port());
    let ended = lab.run(&["run", "foxglove_bridge", "--ros-args", "-p", &port]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("-p port:="), "{}", ended.stderr);
    let ended = lab.run(&["run", "foxglove_bridge", "--ros-args", "-p", "address:=home"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("\"home\" is not an IP address"), "{}", ended.stderr);
}
