//! The tools of `grainlab bag` beside the Python readers of ROS 2, on a run of ours and on recordings of other programs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use grainlab_recordings::{Recording, Selection};
use serde_json::Value;
use system_tests::lab::{Lab, golden};
use system_tests::process::Process;
use system_tests::python;
use system_tests::wait::LIMIT;

const READERS: &str = "mcap_ros2, rosbags, zstandard, lz4, yaml";

/// Runs a command that has to end with exit 0; its output.
#[track_caller]
fn run(lab: &Lab, arguments: &[&str]) -> String {
    lab.run(arguments).assert_code(0).stdout
}

/// Asserts that `bag cat` prints what `reader` reads; returns the number of messages.
#[track_caller]
fn compare(lab: &Lab, python: &Path, reader: &str, path: &Path) -> usize {
    let path = path.to_str().unwrap();
    let lines = lab.write("cat.jsonl", &run(lab, &["bag", "cat", path]));
    python::succeeds(python, "compare_cat.py", &[reader, path, lines.to_str().unwrap()])
        .trim()
        .parse()
        .unwrap()
}

/// Recordings by the Python packages rosbags and mcap.
fn foreign(lab: &Lab, python: &Path) -> PathBuf {
    let folder = lab.folder().join("foreign");
    std::fs::create_dir(&folder).unwrap();
    python::succeeds(python, "make_bags.py", &[folder.to_str().unwrap()]);
    folder
}

#[test]
fn cat_prints_every_value_of_recordings_by_other_programs() {
    let Some(python) = python::with(READERS) else { return };
    let lab = Lab::new();
    let folder = foreign(&lab, &python);
    for name in ["none", "lz4", "zstd", "unchunked"] {
        let path = folder.join(format!("{name}.mcap"));
        assert_eq!(compare(&lab, &python, "mcap", &path), 240, "{name}");
        let info = run(&lab, &["bag", "info", path.to_str().unwrap(), "--format", "json"]);
        let info: serde_json::Value = serde_json::from_str(&info).unwrap();
        assert_eq!(info["messages"], 240, "{name}");
    }
    let bag = folder.join("rosbags");
    assert_eq!(compare(&lab, &python, "rosbags", &bag), 240);
    // Tables have a row for each message.
    for format in ["csv", "json"] {
        let out = format!("tables_{format}");
        run(&lab, &["bag", "convert", bag.to_str().unwrap(), "--format", format, "-o", &out]);
        let extension = if format == "csv" { "csv" } else { "jsonl" };
        for (topic, messages) in [("imu", 200), ("joints", 20), ("camera_image", 20)] {
            let text = std::fs::read_to_string(lab.folder().join(&out).join(format!("{topic}.{extension}")))
                .unwrap();
            assert_eq!(text.lines().count(), messages + usize::from(format == "csv"), "{format} {topic}");
        }
    }
}

#[test]
fn copies_pass_the_acceptance_check_and_python_reads_the_same_values() {
    let lab = Lab::new();
    let Some(python) = python::with(READERS) else { return };
    let ours = lab.launch(&golden("scenes/tiny.toml"), &[]);
    let ours = ours.to_str().unwrap();
    let folder = foreign(&lab, &python);
    let bag = folder.join("rosbags");
    let bag = bag.to_str().unwrap();
    for (arguments, out) in [
        (&[ours, "--start-offset", "0.1", "--duration", "0.2", "--format", "mcap"][..], "cut"),
        (&[bag, "--start", "1700000000.5", "--end", "2023-11-14T22:13:21Z"], "cut_foreign.mcap"),
        (&[ours, "--regex", "/(stress|packing_r.*)", "--format", "mcap", "--compression", "lz4"], "filtered"),
        (&[bag, "--types", "sensor_msgs/msg/Imu", "--format", "mcap", "--compression", "none"], "imu"),
        (&[ours, bag, "--exclude", "rosout"], "merged"),
        (&[bag, "--compression", "zstd"], "small.mcap"),
        (&[ours, "--format", "mcap"], "converted"),
        (&[ours, "--pictures"], "pictured.mcap"),
    ] {
        let arguments = [&["bag", "convert"], arguments, &["-o", out]].concat();
        run(&lab, &arguments);
        let path = lab.folder().join(out);
        python::succeeds(&python, "check_mcap.py", &[path.to_str().unwrap()]);
        let messages = Recording::open(&path).unwrap().info().messages;
        let file = if path.is_dir() { path.join(format!("{out}_0.mcap")) } else { path.clone() };
        assert_eq!(compare(&lab, &python, "mcap", &file), messages as usize, "{out}");
        assert_eq!(compare(&lab, &python, "rosbags", &path), messages as usize, "{out}");
        lab.run(&arguments).assert_code(2).assert_says(&["exists"]);
    }
    let count = |path: &str| Recording::open(&lab.folder().join(path)).unwrap().info().messages;
    assert_eq!((count("imu"), count("small.mcap")), (200, 240));
    assert_eq!(count("converted"), Recording::open(Path::new(ours)).unwrap().info().messages);
    let packings = Recording::open(Path::new(ours)).unwrap();
    let packings = packings.messages(&Selection::topics(["/packing"])).unwrap().count() as u64;
    assert!(packings > 0);
    assert_eq!(count("pictured.mcap"), count("converted") + 2 * packings);
}

#[test]
fn steps_are_played_one_by_one_and_a_recorder_takes_the_topics_it_is_told_to() {
    let lab = Lab::new();
    let source = lab.launch(&golden("scenes/tiny.toml"), &[]);
    let source = source.to_str().unwrap();
    let record = "bag record --regex /(stress|packing|packing_report) --exclude-topics packing --compression lz4 -o again";
    let recorder = lab.start(&record.split(' ').collect::<Vec<_>>());
    // Five steps, and the end of stdin.
    let lines = lab.folder().join("lines");
    std::fs::write(&lines, "\n\ns\n\n\n").unwrap();
    let topics = ["--topics", "stress", "packing", "--wait-for-subscribers", "3"];
    let play = lab
        .command(&[&["bag", "play", source, "--step", "--rate", "inf"], &topics[..]].concat())
        .stdin(std::fs::File::open(&lines).unwrap())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&play.stderr).into_owned();
    assert!(play.status.success() && said.contains("5 messages sent"), "{said}");
    recorder.ended_by(libc::SIGINT).assert_code(0);
    let recording = Recording::open(&lab.folder().join("again")).unwrap();
    let info = recording.info();
    let names: Vec<&str> = info.topics.iter().map(|t| t.name.as_str()).collect();
    assert_eq!((names, info.compression), (vec!["/packing_report", "/stress"], vec!["lz4".to_owned()]));
    assert!((1..=5).contains(&info.messages), "{}", info.messages);
}

/// Topics of types that grainlab does not have, on CycloneDDS.
fn peer(lab: &Lab, python: &Path, what: &str) -> Process {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/foreign_peer.py");
    let mut command = Command::new(python);
    command.arg(script).arg(what).env("ROS_DOMAIN_ID", lab.domain.to_string()).env_remove("CYCLONEDDS_URI");
    Process::start(&mut command)
}

/// Output of the other program: messages by topic.
fn messages(peer: Process) -> BTreeMap<String, Vec<Value>> {
    serde_json::from_str(&peer.ended(LIMIT).assert_code(0).stdout).unwrap()
}

#[test]
fn topics_of_any_type_are_recorded_and_played_back_with_every_value() {
    let Some(python) = python::with(&format!("cyclonedds, {READERS}")) else { return };
    let lab = Lab::new();
    for (file, text) in [
        ("std_msgs/msg/String.msg", "string data\n"),
        ("demo_msgs/msg/One.msg", "uint8 value\n"),
        ("demo_msgs/msg/Pair.msg", "std_msgs/Header header\nOne[] ones\nfloat64[3] xyz\nbool ok\n"),
    ] {
        std::fs::create_dir_all(lab.folder().join("messages").join(file).parent().unwrap()).unwrap();
        lab.write(&format!("messages/{file}"), text);
    }
    let recorder = lab.start(&["bag", "record", "-a", "--msg-path", "messages", "-o", "any"]);
    let sent = messages(peer(&lab, &python, "publish"));
    let ended = recorder.ended_by(libc::SIGINT).assert_code(0);
    let warned = ended.stderr.lines().filter(|l| l.contains("without a schema")).collect::<Vec<_>>();
    let [one] = warned[..] else { panic!("{warned:?}") };
    assert!(one.contains("/mystery") && one.contains("--msg-path"), "{one}");

    // Those with a schema, decoded by three readers.
    let topics: Vec<&str> = sent.keys().map(String::as_str).collect();
    assert_eq!(topics, ["/chatter", "/late", "/mystery", "/scan/pairs"]);
    let known = ["--topics", "chatter", "late", "scan/pairs"];
    run(&lab, &[&["bag", "convert", "any", "--format", "mcap", "-o", "known"], &known[..]].concat());
    let total: usize = sent.iter().filter(|(name, _)| *name != "/mystery").map(|(_, all)| all.len()).sum();
    let known = lab.folder().join("known");
    for (reader, path) in [("mcap", &known.join("known_0.mcap")), ("rosbags", &known)] {
        assert_eq!(compare(&lab, &python, reader, path), total, "{reader}");
    }
    python::succeeds(&python, "check_mcap.py", &[known.to_str().unwrap()]);
    let mut read: BTreeMap<String, Vec<Value>> = BTreeMap::new();
    for line in run(&lab, &["bag", "cat", "known"]).lines() {
        let line: Value = serde_json::from_str(line).unwrap();
        read.entry(line["topic"].as_str().unwrap().to_owned()).or_default().push(line["data"].clone());
    }
    for (name, all) in &read {
        assert_eq!(all, &sent[name], "{name}");
    }

    // The QoS of the publishers, in the file and for rosbag2.
    let recording = Recording::open(&lab.folder().join("any")).unwrap();
    let metadata = std::fs::read_to_string(lab.folder().join("any/metadata.yaml")).unwrap();
    for (topic, kind, reliability, durability) in [
        ("/chatter", "std_msgs/msg/String", 1, 2),
        ("/scan/pairs", "demo_msgs/msg/Pair", 2, 2),
        ("/mystery", "demo_msgs/msg/Mystery", 1, 1),
    ] {
        let channel = recording.channel(topic).unwrap();
        let expected = format!("reliability: {reliability}\n  durability: {durability}\n");
        assert!(channel.qos.contains(&expected), "{topic}: {}", channel.qos);
        assert_eq!(channel.ros_type, kind);
        assert!(metadata.contains(&Value::from(channel.qos.as_str()).to_string()), "{topic}");
    }
    let mystery = recording.channel("/mystery").unwrap();
    assert!(mystery.schema.is_empty() && mystery.schema_encoding.is_empty(), "{mystery:?}");

    // Played back, with the schema and without.
    let listener = peer(&lab, &python, "listen");
    let play = [&["bag", "play", "any", "--topics"], &topics[..]].concat();
    run(&lab, &play);
    assert_eq!(messages(listener), sent);
}

#[test]
fn a_recording_of_another_program_is_played_and_recorded_again_byte_for_byte() {
    let Some(python) = python::with(READERS) else { return };
    let lab = Lab::new();
    let source = foreign(&lab, &python).join("none.mcap");
    std::fs::write(lab.folder().join("qos.yaml"), "/imu: {reliability: best_effort, depth: 300}\n").unwrap();
    let topics = ["--topics", "imu", "joints", "camera/image"];
    let recorder = lab.start(&[&["bag", "record", "-o", "again"], &topics[..]].concat());
    let overrides = ["--qos-profile-overrides-path", "qos.yaml"];
    run(&lab, &[&["bag", "play", source.to_str().unwrap()], &overrides[..]].concat());
    recorder.ended_by(libc::SIGINT).assert_code(0);
    let (before, after) =
        (Recording::open(&source).unwrap(), Recording::open(&lab.folder().join("again")).unwrap());
    for (topic, count, reliability) in [("/imu", 200, 2), ("/joints", 20, 1), ("/camera/image", 20, 1)] {
        let bodies = |recording: &Recording| -> Vec<Vec<u8>> {
            recording.messages(&Selection::topics([topic])).unwrap().map(|m| m.payload.to_vec()).collect()
        };
        let (sent, received) = (bodies(&before), bodies(&after));
        assert_eq!((sent.len(), received.len()), (count, count), "{topic}");
        let orders = |all: &[Vec<u8>]| [0, 1].map(|order| all.iter().filter(|body| body[1] == order).count());
        assert_eq!(orders(&sent), orders(&received), "{topic}");
        assert!(topic != "/imu" || !orders(&sent).contains(&0), "both byte orders are played");
        for (sent, received) in sent.iter().zip(&received) {
            // RTPS fills up the last word.
            assert!(received.starts_with(sent) && received.len() < sent.len() + 4, "{topic}");
        }
        let (old, new) = (before.channel(topic).unwrap(), after.channel(topic).unwrap());
        assert_eq!(old.ros_type, new.ros_type);
        assert!(new.qos.contains(&format!("reliability: {reliability}\n")), "{topic}: {}", new.qos);
    }
}

#[test]
fn a_difference_of_recordings_is_named_by_topic_message_and_field_and_none_is_exit_0() {
    let lab = Lab::new();
    let tiny = golden("scenes/tiny.toml");
    let [one, many] = [&["--one-process"][..], &[]].map(|how| lab.launch(&tiny, how));
    let other = lab.launch(&tiny, &["--seed", "4"]);
    let diff = |a: &Path, b: &Path, more: &[&str]| {
        let [a, b] = [a, b].map(|path| path.to_str().unwrap().to_owned());
        lab.run(&[&["bag", "diff", &a, &b][..], more].concat())
    };
    let same = diff(&one, &many, &[]).assert_code(0);
    let stress = same.stdout.lines().find(|l| l.starts_with("/stress ")).unwrap();
    assert!(stress.contains("same") && stress.contains("differ"), "payload and times: {stress}");
    assert_eq!(diff(&one, &many, &["--topics", "stress", "--times"]).code, Some(1));
    assert_eq!(diff(&one, &many, &["--all"]).code, Some(1), "reports of processes");
    diff(&many, &other, &["--topics", "packing"]).assert_code(1).assert_prints(&["/packing: message 1: "]);
    let without = lab.folder().join("without");
    let [source, to] = [&many, &without].map(|path| path.to_str().unwrap());
    let left_out = ["bag", "convert", source, "--exclude", "stress", "--format", "mcap", "-o", to];
    run(&lab, &left_out);
    let missing = diff(&many, &without, &["--times"]).assert_code(1);
    assert_eq!(missing.stdout.matches("only in A").count(), 1, "{}", missing.stdout);
    // Equal bytes by another definition are other values.
    let swapped = "import sys; from mcap.writer import Writer\n\
                   for name, text in [('xy', 'float64 x\\nfloat64 y'), ('yx', 'float64 y\\nfloat64 x')]:\n    \
                   w = Writer(open(name + '.mcap', 'wb')); w.start('ros2')\n    \
                   c = w.register_channel('/p', 'cdr', w.register_schema('d/msg/P', 'ros2msg', text.encode()))\n    \
                   w.add_message(c, 1, b'\\0\\1\\0\\0' + b'\\1' * 16, 1); w.finish()";
    if let Some(python) = python::with("mcap") {
        python::code(&python, swapped, &[], lab.folder());
        lab.run(&["bag", "diff", "xy.mcap", "yx.mcap"]).assert_code(1).assert_prints(&["its definition"]);
    }
    let refused = |arguments: &[&str], words| {
        lab.run(&[&["bag", "convert", source], arguments].concat()).assert_code(2).assert_says(&[words]);
    };
    refused(&["--start-offset", "500", "-o", "late.mcap"], "the recording has");
    refused(&[to, "-o", "both.csv"], "both.csv: this would be a recording, and has the name of a table");
}
