//! A recording played into fresh nodes or read without nodes has the results of the live run, and what `bag play` sends arrives,
//! or is said to be missing.

use grainlab_msgs::msg::PackingReport;
use grainlab_msgs::{Guid, Qos, Topic, to_cdr, topics};
use grainlab_recordings::{Incoming, Recording, RunWriter, Selection, TopicSpec, WriterOptions};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;
use system_tests::bodies::{decoded, distinct, recorded};
use system_tests::lab::{Lab, summary, undisturbed};
use system_tests::lattice::lattice;
use system_tests::process::Process;
use system_tests::python;
use system_tests::terminal::Terminal;
use system_tests::wait::{LIMIT, until};

/// A recorder of all topics into a folder.
fn recorder_of_all(lab: &Lab, name: &str) -> (Process, PathBuf) {
    (lab.start(&["bag", "record", "-a", "-o", name]), lab.folder().join(name))
}

/// Interrupts each process, and expects exit code 0.
fn end(processes: impl IntoIterator<Item = Process>) {
    for process in processes {
        let ended = process.ended_by(libc::SIGINT).assert_code(0);
        assert!(!ended.stdout.contains("packing_chunk") && !ended.stdout.contains("packing_credit"));
    }
}

#[test]
fn a_recording_played_into_fresh_nodes_gives_the_recorded_bytes() {
    let (live, lab) = (undisturbed(&[]), Lab::new());
    let (recorder, out) = recorder_of_all(&lab, "again");
    let nodes = ["fabric_analyzer", "emt_inversion"].map(|node| lab.start(&["run", node]));
    let subscribers = ["--topics", "packing", "--min-subscribers", "2"];
    lab.run(&[&["bag", "play", &live.to_string_lossy()], &subscribers[..]].concat()).assert_code(0);
    // Results are written to the file at once, so that it can be read while it grows.
    until("the last packing is inverted", || distinct(&out, "/microstructure").len() >= 2);
    end(nodes.into_iter().chain([recorder]));
    for topic in ["/packing", "/packing_report", "/microstructure"] {
        assert_eq!(distinct(&live, topic), distinct(&out, topic), "{topic}");
        assert_eq!(distinct(&live, topic).len(), 2, "{topic}");
    }
}

#[test]
fn analyze_of_a_recording_gives_the_numbers_and_the_bytes_of_the_live_run() {
    let (live, lab) = (undisturbed(&[]), Lab::new());
    let path = live.to_string_lossy();
    let analyzed = lab.run(&["analyze", &path, "--format", "json", "--record", "offline"]).assert_code(0);
    let (states, summary) = (analyzed.json(), summary(&live));
    assert_eq!((states.as_array().unwrap().len(), summary["states"].as_array().unwrap().len()), (2, 2));
    for (state, recorded) in states.as_array().unwrap().iter().zip(summary["states"].as_array().unwrap()) {
        let keys = "step grains phi k z rattlers eps stiffness_pa g12_pa g13_pa theta_pa";
        for key in keys.split(' ') {
            assert!(state[key] == recorded[key] && !state[key].is_null(), "{key}: {state} {recorded}");
        }
    }
    lab.run(&["analyze", &path, "--record", "twice"]).assert_code(0);
    let [once, twice] = ["offline", "twice"].map(|name| {
        let reports = distinct(&lab.folder().join(name), "/packing_report");
        assert!(reports.len() == 2 && reports == distinct(&live, "/packing_report"), "{name}");
        std::fs::read(lab.folder().join(format!("{name}/{name}_0.mcap"))).unwrap()
    });
    assert!(once == twice, "the file depends on its name or on the time of the day");
}

#[test]
fn play_skips_and_names_what_a_live_node_publishes() {
    let lab = Lab::new();
    let analyzer = lab.start(&["run", "fabric_analyzer"]);
    lab.until_announced(&topics::PACKING_REPORT);
    let live = undisturbed(&[]).to_string_lossy().into_owned();
    lab.run(&["bag", "play", &live, "--topics", "packing", "packing_report", "--rate", "50"])
        .assert_code(0)
        .assert_says(&["/packing_report"]);
    analyzer.ended_by(libc::SIGTERM).assert_code(0);
}

/// Makes the recording `large` of packings that are too large for one sample, equal except for their step.
fn record_large_packings(lab: &Lab, packings: u64) -> Vec<Vec<u8>> {
    let spec = TopicSpec::of_contract(&topics::PACKING, &topics::PACKING.absolute_name());
    let folder = lab.folder().join("large");
    let mut run = RunWriter::create(&folder, "large", &[spec], WriterOptions::default()).unwrap();
    let mut packing = lattice(26, 1);
    let mut bodies = Vec::new();
    for step in 1..=packings {
        packing.step = step;
        let payload = to_cdr(&packing);
        let receive_time = 1_700_000_000_000_000_000 + step * 100_000_000;
        let (guid, sequence, payload) = (Guid([7; 16]), step as i64, &payload);
        run.write("/packing", &Incoming { guid, sequence, source_time: None, receive_time, payload })
            .unwrap();
        bodies.push(payload.clone());
    }
    run.finish().unwrap();
    assert!(bodies.iter().all(|body| body.len() > 5_000_000));
    bodies
}

#[test]
fn every_packing_of_sixteen_thousand_grains_is_analysed_and_recorded_whole() {
    const PACKINGS: u64 = 10;
    let lab = Lab::new();
    let bodies = record_large_packings(&lab, PACKINGS);
    let (recorder, out) = recorder_of_all(&lab, "again");
    let analyzer = lab.start(&["run", "fabric_analyzer"]);
    lab.run(&["bag", "play", "large", "--rate", "inf", "--min-subscribers", "2"])
        .assert_code(0)
        .assert_says(&["10 messages sent"]);
    until("every packing is analyzed", || recorded(&out, "/packing_report") >= PACKINGS as usize);
    end([analyzer, recorder]);
    let recording = Recording::open(&out).unwrap();
    let packings = recording.messages(&Selection::topics(["/packing"])).unwrap();
    assert!(packings.map(|m| m.payload.to_vec()).eq(bodies), "the same bytes, each once, in order");
    let reports: Vec<PackingReport> = decoded(&out, "/packing_report");
    assert!(reports.iter().map(|report| report.source_step).eq(1..=PACKINGS));
    let info = recording.info();
    let packing = info.topics.iter().find(|topic| topic.name == "/packing").unwrap();
    assert_eq!((packing.messages, packing.published, packing.lost), (10, Some(10), Some(0)));
}

#[test]
fn a_restarted_analyzer_gets_the_latest_large_packing_and_makes_the_same_bytes() {
    const PACKINGS: u64 = 30;
    let lab = Lab::new();
    record_large_packings(&lab, PACKINGS);
    let (recorder, out) = recorder_of_all(&lab, "again");
    let killed = lab.start(&["run", "fabric_analyzer"]);
    // One packing every tenth of a second; the second analyzer joins while the player is still running.
    let player = lab.start(&["bag", "play", "large", "--min-subscribers", "2"]);
    until("three packings are analyzed", || recorded(&out, "/packing_report") >= 3);
    killed.signal(libc::SIGKILL);
    let analyzer = lab.start(&["run", "fabric_analyzer"]);
    // The killed one lacks the packing that was in transit; those after it are sent without it.
    player.ended(LIMIT).assert_code(3).assert_says(&["1 large message not acknowledged"]);
    let reports = || decoded::<PackingReport>(&out, "/packing_report");
    until("the last packing is analyzed", || reports().last().is_some_and(|r| r.source_step >= PACKINGS));
    end([analyzer, recorder]);
    // Every packing is the same lattice: the results differ only in the step.
    let distinct: std::collections::BTreeSet<Vec<u8>> =
        reports().into_iter().map(|report| to_cdr(&PackingReport { source_step: 0, ..report })).collect();
    assert_eq!(distinct.len(), 1);
    assert_eq!(recorded(&out, "/packing"), PACKINGS as usize);
}

const CHAT: &str = "/chat";

/// A string in CDR.
fn body(text: &str) -> Vec<u8> {
    let length = (text.len() as u32 + 1).to_le_bytes();
    [&[0, 1, 0, 0], &length[..], text.as_bytes(), &[0]].concat()
}

/// Texts of a burst of this many messages.
fn numbers(messages: usize) -> impl Iterator<Item = String> {
    (0..messages).map(|n| n.to_string())
}

/// Makes the recording `burst` of these texts, `spacing` nanoseconds apart, whose publisher offered a depth of 10.
fn make(lab: &Lab, texts: impl IntoIterator<Item = impl AsRef<str>>, spacing: u64) {
    let offered = Qos { reliable: true, transient_local: false, depth: 10 };
    let topic = Topic::outside_contract(CHAT, "std_msgs/msg/String", offered).unwrap();
    let spec = TopicSpec::of_found(&topic, Some("string data\n".to_owned()), "", &[offered]);
    let folder = lab.folder().join("burst");
    let mut writer = RunWriter::create(&folder, "burst", &[spec], WriterOptions::default()).unwrap();
    for (n, text) in texts.into_iter().enumerate() {
        let (guid, sequence, time) = (Guid([1; 16]), n as i64 + 1, 1_000_000_000 + spacing * n as u64);
        let payload = &body(text.as_ref());
        let sample = Incoming { guid, sequence, source_time: Some(time), receive_time: time, payload };
        writer.write(CHAT, &sample).unwrap();
    }
    writer.finish().unwrap();
}

fn play_at_once(lab: &Lab) {
    // On a busy machine discovery takes longer than the player waits by default.
    lab.run(&["bag", "play", "burst", "--rate", "inf", "--wait-for-subscribers", "100"]).assert_code(0);
}

/// A recorder of the topic, once it is ready.
fn recorder(lab: &Lab, out: &str) -> Process {
    let recorder = lab.start(&["bag", "record", "--topics", "chat", "-o", out]);
    until("the recorder has begun", || lab.folder().join(out).exists());
    recorder
}

#[test]
fn a_burst_that_is_played_as_fast_as_possible_arrives_whole_at_a_recorder_and_on_cyclonedds() {
    const MESSAGES: usize = 20_000;
    let lab = Lab::new();
    make(&lab, numbers(MESSAGES), 1_000);
    let recorder = recorder(&lab, "again");
    play_at_once(&lab);
    recorder.ended_by(libc::SIGINT).assert_code(0);
    let recording = Recording::open(&lab.folder().join("again")).unwrap();
    let messages = recording.messages(&Selection::topics([CHAT])).unwrap();
    // RTPS fills up the last word.
    assert!(messages.map(|m| m.payload.to_vec()).eq(numbers(MESSAGES).map(|text| {
        let mut body = body(&text);
        body.resize(body.len().next_multiple_of(4), 0);
        body
    })));

    let Some(python) = python::with("cyclonedds") else { return };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/foreign_peer.py");
    let mut command = Command::new(python);
    command.arg(script).args(["count", CHAT, &MESSAGES.to_string()]);
    command.env("ROS_DOMAIN_ID", lab.domain.to_string()).env_remove("CYCLONEDDS_URI");
    let peer = Process::start(&mut command);
    play_at_once(&lab);
    let counted = peer.ended(LIMIT);
    assert_eq!(counted.stdout.trim(), r#"{"arrived": 20000, "missing": 0}"#, "{}", counted.stderr);
}

#[test]
fn a_playback_to_a_subscriber_that_was_stopped_ends_with_the_number_of_messages_that_it_lacks() {
    let lab = Lab::new();
    make(&lab, numbers(40), 50_000_000);
    let recorder = recorder(&lab, "stopped");
    let player = lab.start(&["bag", "play", "burst"]);
    until("the first messages are recorded", || recorded(&lab.folder().join("stopped"), CHAT) > 0);
    recorder.signal(libc::SIGSTOP);
    let played = player.ended(LIMIT);
    recorder.signal(libc::SIGCONT);
    played.assert_code(3).assert_says(&["40 messages sent", " of 40 messages not acknowledged"]);
}

/// The player discovers the subscriber, which is stopped before it discovers the player.
#[test]
fn a_playback_to_a_subscriber_that_was_stopped_before_the_first_message_ends_with_the_number_of_all_messages()
{
    let Some(python) = python::with("cyclonedds") else { return };
    let lab = Lab::new();
    make(&lab, numbers(40), 1_000);
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/foreign_peer.py");
    let mut command = Command::new(python);
    command.arg(script).args(["count", CHAT, "40"]);
    command.env("ROS_DOMAIN_ID", lab.domain.to_string()).env_remove("CYCLONEDDS_URI");
    let peer = Process::start(&mut command);
    until("its topic is discovered", || lab.run(&["topic", "list"]).stdout.contains(CHAT));
    let player = lab.start(&["bag", "play", "burst", "--rate", "inf"]);
    std::thread::sleep(Duration::from_millis(400));
    peer.signal(libc::SIGSTOP);
    let played = player.ended(LIMIT);
    peer.signal(libc::SIGCONT);
    played.assert_code(3).assert_says(&["40 messages sent", "/chat: 40 of 40 messages not acknowledged"]);
}

#[test]
fn what_a_terminal_obeys_in_a_message_is_shown_by_cat_and_kept_in_a_file() {
    let lab = Lab::new();
    make(&lab, ["a\u{1b}[31m\u{9b}31m\u{202e}b"], 1);
    for format in ["json", "text"] {
        let words = ["bag", "cat", "burst", "--format", format];
        assert!(lab.run(&words).stdout.contains("\u{9b}31m\u{202e}b"));
        let (terminal, stdout) = Terminal::open(200);
        let mut command = lab.command(&words);
        assert!(command.stdout(stdout).stderr(Stdio::null()).status().unwrap().success());
        drop(command);
        let shown = terminal.shown().lines.join("\n");
        assert!(shown.contains(r"\u{9b}31m\u{202e}b"), "{shown:?}");
        assert!(!shown.contains(['\u{1b}', '\u{9b}', '\u{202e}']), "{shown:?}");
    }
}

/// Ends a recorder, which has to say that messages are lost, and returns what it printed.
fn lossy(recorder: Process) -> String {
    let ended = recorder.ended_by(libc::SIGINT).assert_code(3);
    ended.stdout + &ended.stderr
}

#[test]
fn a_message_over_the_limit_is_said_to_be_lost_and_those_behind_it_arrive() {
    let lab = Lab::new();
    let large = "x".repeat(17 << 20);
    make(&lab, ["first", &large, "third", "fourth"], 100_000_000);
    let recorder = recorder(&lab, "again");
    lab.run(&["bag", "play", "burst"]).assert_code(0);
    let printed = lossy(recorder);
    assert!(printed.contains("1 message of") && printed.contains("16777216 bytes"), "{printed}");
    assert_eq!(recorded(&lab.folder().join("again"), CHAT), 3);
    lab.run(&["bag", "check", "again"]).assert_code(3);
}

#[test]
fn messages_that_a_killed_publisher_began_to_send_are_lost() {
    let lab = Lab::new();
    let large = "x".repeat(8 << 20);
    make(&lab, ["first", &large, &large], 2_000_000_000);
    let recorder = recorder(&lab, "cut");
    let player = lab.start(&["bag", "play", "burst"]);
    until("the first message is recorded", || recorded(&lab.folder().join("cut"), CHAT) == 1);
    // Its socket holds the beginning of the second message alone.
    recorder.signal(libc::SIGSTOP);
    std::thread::sleep(Duration::from_secs(3));
    player.signal(libc::SIGKILL);
    player.ended(LIMIT);
    recorder.signal(libc::SIGCONT);
    // What the publisher began to send is due once the recorder has heard of it.
    std::thread::sleep(Duration::from_secs(1));
    let printed = lossy(recorder);
    assert!(printed.contains("messages were published and are not in the recording"), "{printed}");
    assert_eq!(recorded(&lab.folder().join("cut"), CHAT), 1);
}
