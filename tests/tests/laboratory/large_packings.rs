//! Packings that are too large for one sample, between real processes: played, analysed and recorded again.

use grainlab_msgs::msg::PackingReport;
use grainlab_msgs::{Guid, from_cdr, to_cdr, topics};
use grainlab_recordings::{Incoming, Recording, RunWriter, Selection, TopicSpec, WriterOptions};
use std::path::Path;
use system_tests::lab::{LIMIT, Lab, until};
use system_tests::lattice::lattice;

const PACKINGS: u64 = 30;
const WRITER: Guid = Guid([7; 16]);

/// A recording of [`PACKINGS`] packings, equal except for their step.
fn record(directory: &Path, edge: usize) -> Vec<Vec<u8>> {
    let topic = topics::PACKING;
    let spec = TopicSpec::of_contract(&topic, &topic.absolute_name());
    let mut run = RunWriter::create(directory, "large", &[spec], WriterOptions::default()).unwrap();
    let mut packing = lattice(edge, 1);
    let mut bodies = Vec::new();
    for step in 1..=PACKINGS {
        packing.step = step;
        let body = to_cdr(&packing);
        let receive_time = 1_700_000_000_000_000_000 + step * 100_000_000;
        let (guid, sequence) = (WRITER, step as i64);
        let sample = Incoming { guid, sequence, source_time: None, receive_time, payload: &body };
        run.write("/packing", &sample).unwrap();
        bodies.push(body);
    }
    run.finish().unwrap();
    bodies
}

fn recorded(run: &Path, topic: &str) -> Vec<Vec<u8>> {
    let Ok(recording) = Recording::open(run) else { return Vec::new() };
    recording
        .messages(&Selection::topics([topic]))
        .map(|m| m.map(|m| m.payload.to_vec()).collect())
        .unwrap_or_default()
}

#[test]
fn thirty_of_thirty_packings_of_sixteen_thousand_grains_are_analysed_and_recorded_whole() {
    let lab = Lab::new();
    let (source, out) = (lab.folder().join("large"), lab.folder().join("again"));
    let bodies = record(&source, 26);
    assert!(bodies.iter().all(|body| body.len() > 5_000_000));
    let recorder = lab.start(&["bag", "record", "-a", "-o", &out.to_string_lossy()]);
    let analyzer = lab.start(&["run", "fabric_analyzer"]);
    let played =
        lab.run(&["bag", "play", &source.to_string_lossy(), "--rate", "inf", "--min-subscribers", "2"]);
    assert_eq!(played.code, Some(0), "{}\n{}", played.stdout, played.stderr);
    assert!(played.stderr.contains("30 messages sent"), "{}", played.stderr);
    until("every packing is analyzed", || recorded(&out, "/packing_report").len() >= PACKINGS as usize);
    for node in [analyzer, recorder] {
        node.signal(libc::SIGINT);
        let ended = node.ended(LIMIT);
        assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
        assert!(!ended.stdout.contains("packing_chunk") && !ended.stdout.contains("packing_credit"));
    }
    assert!(recorded(&out, "/packing") == bodies, "the same bytes, each once, in order");
    let report = |body: &Vec<u8>| from_cdr::<PackingReport>(body).expect("a report");
    let steps: Vec<u64> =
        recorded(&out, "/packing_report").iter().map(|body| report(body).source_step).collect();
    assert_eq!(steps, (1..=PACKINGS).collect::<Vec<_>>());
    let info = Recording::open(&out).unwrap().info();
    let packing = info.topics.iter().find(|topic| topic.name == "/packing").unwrap();
    assert_eq!((packing.messages, packing.published, packing.lost), (30, Some(30), Some(0)));
}

#[test]
fn a_restarted_analyzer_gets_the_latest_large_packing_and_makes_the_same_bytes() {
    let lab = Lab::new();
    let (source, out) = (lab.folder().join("large"), lab.folder().join("again"));
    record(&source, 26);
    let recorder = lab.start(&["bag", "record", "-a", "-o", &out.to_string_lossy()]);
    let killed = lab.start(&["run", "fabric_analyzer"]);
    // One packing every tenth of a second; the second analyzer joins while the player is still running.
    let player = lab.start(&["bag", "play", &source.to_string_lossy(), "--min-subscribers", "2"]);
    until("three packings are analyzed", || recorded(&out, "/packing_report").len() >= 3);
    killed.signal(libc::SIGKILL);
    let analyzer = lab.start(&["run", "fabric_analyzer"]);
    let played = player.ended(LIMIT);
    assert_eq!(played.code, Some(0), "{}\n{}", played.stdout, played.stderr);
    let report = |body: &Vec<u8>| from_cdr::<PackingReport>(body).unwrap();
    let last = || recorded(&out, "/packing_report").last().map(report);
    until("the last packing is analyzed", || last().is_some_and(|report| report.source_step >= PACKINGS));
    for node in [analyzer, recorder] {
        node.signal(libc::SIGINT);
        let ended = node.ended(LIMIT);
        assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    }
    // Every packing is the same lattice: the results differ only in the step.
    let reports = recorded(&out, "/packing_report");
    let distinct: std::collections::BTreeSet<Vec<u8>> =
        reports.iter().map(|body| to_cdr(&PackingReport { source_step: 0, ..report(body) })).collect();
    assert_eq!(distinct.len(), 1);
    assert_eq!(recorded(&out, "/packing").len(), PACKINGS as usize);
}
