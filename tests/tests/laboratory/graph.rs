//! The ROS graph as commands, beside the laboratory and beside planted faults.

use grainlab_msgs::msg::{StrainRate, Stress};
use grainlab_msgs::{Qos, Topic, TypeInfo, topics};
use grainlab_node_kit::{Bus, DdsBus, Demand, Names, Network, Publisher};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};
use system_tests::lab::{Lab, golden, grainlab};
use system_tests::process::{Ended, Process};
use system_tests::python;
use system_tests::wait::LIMIT;

fn json(ended: &Ended) -> Value {
    serde_json::from_str(&ended.stdout).unwrap_or_else(|e| panic!("{e}: {}\n{}", ended.stdout, ended.stderr))
}

/// A node of this test in the domain of the laboratory.
fn bus(lab: &Lab, name: &str) -> DdsBus {
    DdsBus::open(Network::localhost(lab.domain), Names::new(name).unwrap()).unwrap()
}

/// Publishes at a rate until it is stopped; returns the true rate.
fn publish_at(bus: &mut DdsBus, hertz: f64, seconds: f64) -> f64 {
    let publisher = Publisher::<StrainRate>::advertise(bus, &topics::STRAIN_RATE).unwrap();
    let start = Instant::now();
    let mut count = 0_u64;
    while start.elapsed().as_secs_f64() < seconds {
        count += 1;
        // A reader that is too slow loses samples, which the measurement must not be misled by.
        let _ = publisher.publish(bus, &StrainRate { sequence: count, ..StrainRate::default() });
        let due = Duration::from_secs_f64(count as f64 / hertz);
        while start.elapsed() < due {
            std::thread::sleep(due.saturating_sub(start.elapsed()).min(Duration::from_micros(50)));
        }
    }
    count as f64 / start.elapsed().as_secs_f64()
}

#[test]
fn the_rate_of_a_fast_topic_is_right_to_a_hundredth() {
    let lab = Lab::new();
    let mut talker = bus(&lab, "talker");
    let publishing = std::thread::spawn(move || publish_at(&mut talker, 5000.0, 8.0));
    lab.until_announced(&topics::STRAIN_RATE);
    let measured = lab.run(&["topic", "hz", "/strain_rate", "-d", "4", "--format", "json"]);
    let truth = publishing.join().unwrap();
    let rate = json(&measured)["rate_hz"].as_f64().unwrap();
    assert!((rate / truth - 1.0).abs() < 0.01, "{rate} Hz measured, {truth} Hz published");
}

#[test]
fn commands_show_and_set_what_a_running_laboratory_has() {
    let lab = Lab::new();
    let scene = golden("scenes/endless.toml");
    let run = lab.start(&["launch", "--scene", scene.to_str().unwrap()]);
    lab.until_recorded(1000);

    let nodes = json(&lab.run(&["node", "list", "--format", "json"]));
    let names: BTreeSet<&str> = nodes.as_array().unwrap().iter().filter_map(Value::as_str).collect();
    for node in ["/dem_simulator", "/servo_controller", "/fabric_analyzer", "/emt_inversion", "/recorder"] {
        assert!(names.contains(node), "{node} in {names:?}");
    }

    let listed = json(&lab.run(&["topic", "list", "--format", "json"]));
    for topic in listed.as_array().unwrap() {
        let name = topic["name"].as_str().unwrap();
        let ended = lab.run(&["topic", "echo", name, "--once", "-d", "1", "--format", "json"]);
        assert_eq!(ended.code, Some(0), "{name}: {}", ended.stderr);
    }
    let stress = json(&lab.run(&["topic", "echo", "/stress", "--once", "--format", "json"]));
    let decoded: Stress = serde_json::from_value(stress).expect("every field of the message");
    assert!(decoded.stress.zz > 0.0 && decoded.sequence > 0);

    for line in [
        "topic list -t",
        "topic echo /stress grainlab_msgs/msg/Stress --once",
        "topic echo /stress --field stress.zz --once",
        "topic echo --once /stress --qos-reliability best_effort --qos-durability volatile --qos-depth 5",
        "topic echo /run_state -n 1 --truncate-length 3",
        "topic info /stress",
        "topic hz /stress -d 1",
        r#"topic pub -t 3 --rate 10 -w 0 /chatter std_msgs/msg/String {"data":"hello"}"#,
        r#"topic pub -1 -w 0 /cmd_vel geometry_msgs/msg/Twist {"linear":{"x":2.0}}"#,
        "node list",
        "node info dem_simulator",
        "param list",
        "param list /dem_simulator",
        "param get /dem_simulator threads",
        "param set /emt_inversion use_sim_time false",
        "interface show geometry_msgs/msg/Twist",
        "interface show std_srvs/srv/SetBool",
    ] {
        let ended = lab.run(&line.split(' ').collect::<Vec<_>>());
        assert!(
            ended.code == Some(0) && !ended.stdout.is_empty(),
            "{line}: {}{}",
            ended.stdout,
            ended.stderr
        );
    }

    let info = json(&lab.run(&["node", "info", "/servo_controller", "--format", "json"]));
    assert_eq!(info["publishers"]["/strain_rate"], "grainlab_msgs/msg/StrainRate");
    assert_eq!(info["subscriptions"]["/stress"], "grainlab_msgs/msg/Stress");
    assert_eq!(
        info["service_servers"]["/servo_controller/get_parameters"],
        "rcl_interfaces/srv/GetParameters"
    );

    assert_eq!(json(&lab.run(&["param", "get", "/dem_simulator", "seed", "--format", "json"])), 1);
    let refused = lab.run(&["param", "set", "/dem_simulator", "seed", "5"]);
    assert!(refused.code == Some(1) && refused.stderr.contains("read-only"), "{}", refused.stderr);
    let unknown = lab.run(&["param", "get", "/dem_simulator", "seeds"]);
    assert!(unknown.code == Some(1) && unknown.stderr.contains("seed"), "{}", unknown.stderr);
    assert_eq!(lab.run(&["param", "set", "/dem_simulator", "use_sim_time", "true"]).code, Some(0));
    assert_eq!(lab.run(&["param", "get", "/dem_simulator", "use_sim_time"]).stdout, "true\n");
    assert_eq!(lab.run(&["param", "get", "/recorder", "append"]).stdout, "false\n");
    let parameters = json(&lab.run(&["param", "list", "--format", "json"]));
    for (node, parameter) in [("/dem_simulator", "threads"), ("/recorder", "append")] {
        assert!(parameters[node].as_array().unwrap().contains(&parameter.into()), "{node}: {parameters}");
    }

    let states = json(&lab.run(&["node", "state", "--format", "json"]));
    for state in states.as_array().unwrap() {
        assert!(state["level"] == "ok" && !state["state"].as_str().unwrap().is_empty(), "{state}");
    }
    let healthy = lab.run(&["doctor", "--format", "json"]);
    assert_eq!(healthy.code, Some(0), "{}", healthy.stdout);
    run.signal(libc::SIGINT);
    assert_eq!(run.ended(LIMIT).code, Some(130));
}

/// A topic of the contract under another name, type or QoS.
fn other(topic: Topic, name: &'static str, qos: Qos) -> Topic {
    Topic { name, qos, ..topic }
}

/// Kinds of the findings, and the exit code.
fn diagnosed(lab: &Lab) -> (BTreeSet<String>, Option<i32>) {
    let ended = lab.run(&["doctor", "--format", "json"]);
    let found = json(&ended)["findings"].as_array().unwrap().clone();
    (found.iter().map(|f| f["kind"].as_str().unwrap().to_owned()).collect(), ended.code)
}

#[test]
fn the_doctor_finds_every_fault_planted_in_a_domain() {
    let lab = Lab::new();
    let mut writer = bus(&lab, "writer");
    let mut reader = bus(&lab, "reader");
    let volatile = Qos { transient_local: false, ..Qos::STREAM };
    let best_effort = Qos { reliable: false, ..volatile };
    let latched = Qos::LATCHED;
    let stress = topics::STRESS;
    // Reliability and durability that do not fit.
    writer.advertise(&other(stress, "/weak", best_effort)).unwrap();
    reader.subscribe(&other(stress, "/weak", volatile), Demand::reliable(10)).unwrap();
    writer.advertise(&other(stress, "/early", volatile)).unwrap();
    reader.subscribe(&other(stress, "/early", latched), Demand::reliable(10)).unwrap();
    // Two types of one topic.
    writer.advertise(&other(stress, "/both", volatile)).unwrap();
    let info = TypeInfo::of::<StrainRate>();
    reader.subscribe(&Topic { info, ..other(stress, "/both", volatile) }, Demand::reliable(10)).unwrap();
    // A namespace that one side has.
    writer.advertise(&other(topics::PACKING_REPORT, "/lab/packing_report", latched)).unwrap();
    reader
        .subscribe(&other(topics::PACKING_REPORT, "/packing_report", latched), Demand::reliable(10))
        .unwrap();
    // Two simulators by hand, and two nodes of one name.
    let mut twins = [bus(&lab, "twin"), bus(&lab, "twin")];
    for twin in &mut twins {
        twin.advertise(&topics::STRESS).unwrap();
    }
    // A node whose process is stopped.
    let stopped = lab.start(&["run", "fabric_analyzer"]);
    lab.until_announced(&topics::PACKING_REPORT);
    stopped.signal(libc::SIGSTOP);
    // A node that waits for a clock.
    let waiting = lab.start(&["run", "emt_inversion", "--ros-args", "-p", "use_sim_time:=true"]);
    // Nodes announce their endpoints when they wait.
    for bus in [&mut writer, &mut reader].into_iter().chain(&mut twins) {
        bus.wait(Duration::from_millis(500));
    }

    let (found, code) = diagnosed(&lab);
    for kind in [
        "reliability_mismatch",
        "durability_mismatch",
        "type_mismatch",
        "namespace_mismatch",
        "duplicate_node",
        "duplicate_publisher",
        "stopped_process",
        "no_clock",
    ] {
        assert!(found.contains(kind), "{kind} is not in {found:?}");
    }
    assert_eq!(code, Some(1));
    stopped.signal(libc::SIGCONT);
    for mut process in [stopped, waiting] {
        process.signal(libc::SIGINT);
        assert!(process.runs());
        process.ended(LIMIT);
    }

    let mut command = lab.command(&["doctor", "--format", "json"]);
    let ended = Process::start(command.env("ROS_DOMAIN_ID", "233")).ended(LIMIT);
    assert_eq!((json(&ended)["findings"][0]["kind"].as_str(), ended.code), (Some("environment"), Some(1)));
}

#[test]
fn the_doctor_finds_a_network_that_drops_what_discovery_needs() {
    let can = Command::new("unshare").args(["-n", "ip", "link"]).output().is_ok_and(|o| o.status.success());
    if !can {
        return python::say_skipped("no right to make a network namespace here, or no `ip`");
    }
    let lab = Lab::new();
    let kinds = |script: &str| {
        let mut command = Command::new("unshare");
        command
            .args(["-n", "sh", "-ec", script])
            .arg(grainlab())
            .current_dir(lab.folder())
            .env("ROS_DOMAIN_ID", "3");
        let ended = Process::start(&mut command).ended(LIMIT);
        let found = json(&ended)["findings"].as_array().unwrap().clone();
        found.iter().map(|f| f["kind"].as_str().unwrap().to_owned()).collect::<BTreeSet<_>>()
    };
    let whole = kinds("ip link set lo up; \"$0\" doctor --format json");
    assert!(!whole.contains("no_multicast") && !whole.contains("blocked_ports"), "{whole:?}");
    // Loopback is down: nothing arrives.
    let cut = kinds("\"$0\" doctor --format json");
    for kind in ["no_multicast", "blocked_ports"] {
        assert!(cut.contains(kind), "{kind} is not in {cut:?}");
    }
}

#[test]
fn the_doctor_is_right_about_policies_of_another_dds_that_are_not_sent() {
    let Some(python) = python::with("cyclonedds") else { return };
    let lab = Lab::new();
    let mut pairs = Command::new(python);
    let pairs = Process::start(
        pairs
            .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/qos_pairs.py"))
            .env("ROS_DOMAIN_ID", lab.domain.to_string()),
    );
    system_tests::wait::until("twelve topics", || lab.run(&["topic", "list"]).stdout.lines().count() == 12);
    let doctor = json(&lab.run(&["doctor", "--format", "json"]));
    std::thread::sleep(Duration::from_secs(3));
    pairs.signal(libc::SIGTERM);
    let matched = json(&pairs.ended(LIMIT));
    let matched = matched.as_object().unwrap();
    assert_eq!(matched.values().filter(|m| **m == false).count(), 5, "{matched:?}");
    for (topic, is_matched) in matched {
        let named = |f: &Value| f["what"].as_str().unwrap().starts_with(&format!("{topic}: "));
        let is_wrong = doctor["findings"].as_array().unwrap().iter().any(named);
        assert_ne!(*is_matched, is_wrong, "{topic}: {doctor}");
    }
    let alone = lab.run(&["doctor", "--format", "json"]);
    let kinds =
        json(&alone)["findings"].as_array().unwrap().iter().map(|f| f["kind"].clone()).collect::<Vec<_>>();
    assert!(kinds.contains(&"empty_domain".into()), "{kinds:?}");
}
