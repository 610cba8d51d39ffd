//! Written data are read back unchanged.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use crate::reference_packing::reference;
use crate::support::{
    ROBOT, SIMULATOR, START, clock, contract, file_with, open, options, post, run_in, said, sample, stress,
    write_run,
};
use grainlab_core::Packing;
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::{from_cdr, msg, to_cdr, topics};
use grainlab_recordings::import::{ImportOptions, load};
use grainlab_recordings::{
    METADATA_RECORD, Outcome, Recording, RunWriter, Selection, TopicSpec, WriterOptions,
};

#[test]
fn every_message_comes_back_with_its_bytes_times_and_sequence() {
    let root = tempfile::tempdir().unwrap();
    let (directory, _) = run_in(&root, 500);
    let recording = open(&directory);
    let all: Vec<_> = recording.messages(&Selection::default()).unwrap().collect();
    assert_eq!(all.len(), 500 + 50 + 1);
    assert!(all.windows(2).all(|w| w[0].log_time < w[1].log_time), "log times must increase strictly");
    assert!(all.iter().all(|m| m.publish_time <= m.log_time));
    let stresses: Vec<_> = recording.messages(&Selection::topics(["stress"])).unwrap().collect();
    for (k, m) in stresses.iter().enumerate() {
        let n = k as u64 + 1;
        assert_eq!((m.sequence, m.channel.topic.as_str()), (n as u32, "/stress"));
        assert_eq!(m.publish_time, START + n * 1_000_000 - 30_000);
        assert_eq!(&*m.payload, stress(n));
        assert_eq!(from_cdr::<msg::Stress>(&m.payload).unwrap().step, 10 * n);
    }
    assert_eq!(stresses.len(), 500);
    assert!(recording.warnings().is_empty());
    assert_eq!(recording.check().warnings, []);
}

#[test]
fn attachments_metadata_channels_and_the_account_come_back() {
    let root = tempfile::tempdir().unwrap();
    let (directory, _) = run_in(&root, 200);
    let recording = Recording::open(&directory.join("demo-7-1_0.mcap")).unwrap();
    let stored = recording.stored_files();
    let names: Vec<_> = stored.iter().map(|f| (f.name.as_str(), f.media_type.as_str())).collect();
    assert_eq!(names, [("demo.toml", "application/toml"), ("late.txt", "text/plain")]);
    assert_eq!(stored[0].bytes, b"name = \"demo\"\n");
    let metadata = recording.metadata(METADATA_RECORD).unwrap();
    assert_eq!((metadata["seed"].as_str(), metadata["finished"].as_str()), ("7", "true"));
    let channel = recording.channel("packing").unwrap();
    assert!(channel.is_latched() && !recording.channel("/stress").unwrap().is_latched());
    assert_eq!(channel.ros_type, "grainlab_msgs/msg/Packing");
    assert!(channel.type_hash.starts_with("RIHS01_") && channel.definition.contains("MSG: std_msgs/Header"));
    let ledger = recording.ledger().unwrap();
    let stress = ledger.iter().find(|t| t.name == "/stress").unwrap();
    assert_eq!((stress.published, stress.recorded, stress.lost, stress.repeated), (200, 200, 0, 0));
    assert_eq!(stress.writers[0].node.as_deref(), Some("/dem_simulator"));
    assert!(
        ledger.iter().any(|t| t.name == "/moduli" && t.published == 0),
        "silent topics are accounted for"
    );
    let info = recording.info();
    assert!(info.complete && info.profile == "ros2" && info.compression == ["zstd"] && info.messages == 221);
    let json = serde_json::to_value(&info).unwrap();
    assert_eq!(json["topics"].as_array().unwrap().len(), contract().len());
    let table = info.to_string();
    assert!(table.contains("/stress") && table.contains("grainlab_msgs/msg/Stress"), "{table}");
}

#[test]
fn a_time_range_includes_its_start_and_excludes_its_end() {
    let root = tempfile::tempdir().unwrap();
    let (directory, _) = run_in(&root, 300);
    let recording = open(&directory);
    let (start, end) = (START + 100 * 1_000_000, START + 200 * 1_000_000);
    let selection = Selection { start: Some(start), end: Some(end), ..Selection::topics(["/stress"]) };
    let found: Vec<_> = recording.messages(&selection).unwrap().map(|m| m.sequence).collect();
    assert_eq!(found, (100..200).collect::<Vec<u32>>());
}

#[test]
fn arrival_times_that_stand_still_or_go_back_give_increasing_log_times() {
    let root = tempfile::tempdir().unwrap();
    let mut run = RunWriter::create(&root.path().join("r"), "r", &contract(), options()).unwrap();
    let mut log_times = Vec::new();
    for (n, time) in [START, START, START - 5_000_000, START + 1, START + 10].into_iter().enumerate() {
        match run.write("/stress", &sample(SIMULATOR, n as i64 + 1, time, &stress(1))).unwrap() {
            Outcome::Recorded { log_time } => log_times.push(log_time - START),
            Outcome::Repeated => panic!("message {n} is new"),
        }
    }
    assert_eq!(log_times, [0, 1, 2, 3, 10]);
    run.finish().unwrap();
}

#[test]
fn repeats_are_counted_and_not_written_and_two_writers_are_separate() {
    let root = tempfile::tempdir().unwrap();
    let directory = root.path().join("r");
    let mut run = RunWriter::create(&directory, "r", &contract(), options()).unwrap();
    let body = stress(1);
    for (guid, sequence) in [(SIMULATOR, 1), (SIMULATOR, 1), (ROBOT, 1), (SIMULATOR, 3)] {
        run.write("/stress", &sample(guid, sequence, START, &body)).unwrap();
    }
    let finished = run.finish().unwrap();
    assert_eq!(finished.messages, 3);
    let recording = open(&directory);
    assert_eq!(said(&recording).len(), 3);
    let ledger = recording.ledger().unwrap();
    let stress = ledger.iter().find(|t| t.name == "/stress").unwrap();
    assert_eq!((stress.published, stress.recorded, stress.lost, stress.repeated), (4, 3, 1, 0));
    assert_eq!(stress.redelivered, 1);
    assert_eq!(stress.writers.iter().find(|w| w.guid == SIMULATOR.to_string()).unwrap().gaps, [(2, 2)]);
}

#[test]
fn what_the_recorder_cannot_take_is_refused_by_name() {
    let root = tempfile::tempdir().unwrap();
    let directory = root.path().join("r");
    let mut run = RunWriter::create(&directory, "r", &contract(), options()).unwrap();
    let body = clock(1);
    let unknown = run.write("/nothing", &sample(SIMULATOR, 1, START, &body)).unwrap_err();
    assert!(unknown.to_string().starts_with("topic /nothing was not declared"), "{unknown}");
    let short = run.write("/clock", &sample(SIMULATOR, 1, START, &[0, 1])).unwrap_err();
    assert!(short.to_string().starts_with("message 1 on /clock has 2 bytes"), "{short}");
    let mut other = contract().remove(0);
    run.add_topic(&other).unwrap();
    other.ros_type = "x/msg/Y".into();
    assert!(run.add_topic(&other).unwrap_err().to_string().contains("already recorded with another type"));
    // None of these errors ended the recording.
    run.write("/clock", &sample(SIMULATOR, 1, START, &body)).unwrap();
    assert_eq!(run.finish().unwrap().messages, 1);
    let again = RunWriter::create(&directory, "r", &contract(), options());
    assert!(again.err().unwrap().to_string().contains("never overwritten"));
}

#[test]
fn a_disk_too_full_is_refused_at_the_start_and_survived_later() {
    let root = tempfile::tempdir().unwrap();
    let impossible = WriterOptions { free_to_start: u64::MAX, ..options() };
    let refused = RunWriter::create(&root.path().join("a"), "a", &contract(), impossible);
    assert!(refused.err().unwrap().to_string().contains("the recording was not begun"));
    let directory = root.path().join("b");
    let fills = WriterOptions { free_to_continue: u64::MAX, flush_interval: Duration::ZERO, ..options() };
    let mut run = RunWriter::create(&directory, "b", &contract(), fills).unwrap();
    let stopped = run.write("/stress", &sample(SIMULATOR, 1, START, &stress(1)));
    assert!(stopped.unwrap_err().to_string().contains("bytes are free on this file system"));
    let refused = run.write("/stress", &sample(SIMULATOR, 2, START, &stress(2)));
    assert!(refused.unwrap_err().to_string().contains("an earlier error ended this recording"));
    run.ledger_mut().report("/stress", SIMULATOR, 2);
    run.finish().unwrap();
    let recording = open(&directory);
    assert_eq!(said(&recording).len(), 1);
    assert!(recording.metadata(METADATA_RECORD).unwrap()["ended_by"].contains("bytes are free"));
    assert_eq!(recording.ledger().unwrap().iter().map(|t| t.lost).sum::<u64>(), 1);
}

#[test]
fn a_quiet_topic_is_on_disk_after_the_flush_interval() {
    let root = tempfile::tempdir().unwrap();
    let directory = root.path().join("r");
    let patient = WriterOptions { flush_interval: Duration::from_millis(400), ..WriterOptions::default() };
    let mut run = RunWriter::create(&directory, "r", &contract(), patient).unwrap();
    run.write("/stress", &sample(SIMULATOR, 1, START, &stress(1))).unwrap();
    let count = || said(&open(&directory)).len();
    run.tick(Instant::now()).unwrap();
    assert_eq!(count(), 0, "the chunk is still open");
    run.tick(Instant::now() + Duration::from_millis(401)).unwrap();
    assert_eq!(count(), 1);
    run.finish().unwrap();
}

#[test]
fn a_dropped_writer_leaves_a_complete_file_marked_as_unfinished() {
    let root = tempfile::tempdir().unwrap();
    let directory = root.path().join("r");
    let mut run = RunWriter::create(&directory, "r", &contract(), options()).unwrap();
    run.write("/stress", &sample(SIMULATOR, 1, START, &stress(1))).unwrap();
    drop(run);
    let recording = open(&directory);
    assert!(recording.info().complete);
    assert_eq!(recording.metadata(METADATA_RECORD).unwrap()["finished"], "false");
    assert_eq!(said(&recording).len(), 1);
}

#[test]
fn metadata_yaml_agrees_with_the_file() {
    let root = tempfile::tempdir().unwrap();
    let directory = root.path().join("demo-7-1");
    write_run(&directory, 40);
    let text = std::fs::read_to_string(directory.join("metadata.yaml")).unwrap();
    let yaml: serde_json::Value = serde_saphyr::from_str(&text).unwrap();
    let bag = &yaml["rosbag2_bagfile_information"];
    assert_eq!((bag["version"].as_u64(), bag["storage_identifier"].as_str()), (Some(8), Some("mcap")));
    assert_eq!(bag["message_count"].as_u64(), Some(44));
    let (first, last) = open(&directory).time_range().unwrap();
    assert_eq!(bag["starting_time"]["nanoseconds_since_epoch"].as_u64(), Some(first));
    assert_eq!(bag["duration"]["nanoseconds"].as_u64(), Some(last - first));
    let counts: BTreeMap<_, _> = bag["topics_with_message_count"]
        .as_array()
        .unwrap()
        .iter()
        .map(|t| (t["topic_metadata"]["name"].as_str().unwrap(), t["message_count"].as_u64().unwrap()))
        .collect();
    assert_eq!((counts["/stress"], counts["/clock"], counts["/moduli"]), (40, 4, 0));
    let recording = open(&directory);
    for topic in bag["topics_with_message_count"].as_array().unwrap() {
        let metadata = &topic["topic_metadata"];
        let channel = recording.channel(metadata["name"].as_str().unwrap()).unwrap();
        // If these differ, readers of rosbag2 recordings find no message of the topic.
        assert_eq!(metadata["offered_qos_profiles"].as_str(), Some(channel.qos.as_str()));
        assert_eq!(metadata["type_description_hash"].as_str(), Some(channel.type_hash.as_str()));
    }
}

#[test]
fn a_file_exceeds_its_size_by_one_chunk_at_most_however_fast_messages_come() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("fast");
    let (chunk_size, split_bytes) = (8_u64 << 10, 100_u64 << 10);
    let compression = grainlab_recordings::Compression::None;
    let options = WriterOptions { chunk_size, split_bytes, compression, ..options() };
    let mut run = RunWriter::create(&path, "fast", &contract(), options).unwrap();
    let schemas = std::fs::metadata(run.file()).unwrap().len();
    let payload = stress(1);
    let count = 4_000;
    for n in 1..=count {
        run.write("/stress", &sample(SIMULATOR, n, START + n as u64, &payload)).unwrap();
    }
    let finished = run.finish().unwrap();
    assert!(finished.files.len() > 5, "{:?}", finished.files);
    // Behind the data are the open chunk of a message, the ledger, and the index with the schemas again.
    let rest = 2 * schemas + (32 << 10);
    for file in &finished.files {
        let size = std::fs::metadata(file).unwrap().len();
        assert!(size <= split_bytes + chunk_size + rest, "{}: {size}", file.display());
    }
    assert_eq!(said(&open(&path)).len(), count as usize);
}

#[test]
fn the_message_of_the_greatest_log_time_is_read_and_an_end_leaves_it_out() {
    let root = tempfile::tempdir().unwrap();
    let directory = root.path().join("r");
    let mut run = RunWriter::create(&directory, "r", &contract(), options()).unwrap();
    for (n, time) in [(1, 5), (2, u64::MAX)] {
        run.write("/stress", &sample(SIMULATOR, n, time, &stress(n as u64))).unwrap();
    }
    run.finish().unwrap();
    let recording = open(&directory);
    let count = |end| recording.messages(&Selection { end, ..Selection::default() }).unwrap().count();
    assert_eq!((count(None), count(Some(u64::MAX)), count(Some(5))), (2, 1, 0));
}

#[test]
fn the_last_message_is_found_whatever_its_time() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("late");
    let mut run = RunWriter::create(&path, "late", &contract(), options()).unwrap();
    for (n, time) in [(1, START), (2, u64::MAX)] {
        run.write("/stress", &sample(SIMULATOR, n, time, &stress(n as u64))).unwrap();
    }
    run.finish().unwrap();
    let recording = open(&path);
    assert_eq!(recording.last("stress").unwrap().unwrap().log_time, u64::MAX);
    assert!(recording.last("/packing").unwrap().is_none() && recording.last("/none").is_err());
}

#[test]
fn a_whole_file_of_another_program_is_sound_and_its_losses_are_not_judged() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("foreign.mcap");
    let bytes = file_with(mcap::WriteOptions::new().library("libmcap 2.0"), |writer| {
        let channel = writer.add_channel(0, "/imu", "cdr", &Default::default()).unwrap();
        post(writer, channel, 5, &[0, 1, 0, 0]);
    });
    std::fs::write(&path, bytes).unwrap();
    let check = open(&path).check();
    assert!(check.warnings.is_empty() && check.unaccounted.is_empty(), "{check:?}");
    assert_eq!((check.messages, check.lost, check.unjudged), (1, None, vec![path]));
}

#[test]
fn a_recorded_packing_comes_back_bit_for_bit() {
    let root = tempfile::tempdir().unwrap();
    let directory = root.path().join("r");
    let p = Packing { time: 0.1 + 0.2, friction: f64::INFINITY, ..reference().packing };
    let row = &topics::PACKING;
    let spec = TopicSpec::of_contract(row, &row.absolute_name());
    let mut run = RunWriter::create(&directory, "r", &[spec], options()).unwrap();
    for (n, step) in [(1, 10), (2, 20)] {
        let body = to_cdr(&packing_message(&Packing { step, ..p.clone() }, "demo", vec![1, 2]));
        run.write("/packing", &sample(SIMULATOR, n, START, &body)).unwrap();
    }
    run.finish().unwrap();
    let loaded = load(&directory, &ImportOptions::default()).unwrap();
    assert_eq!(loaded.packings.iter().map(|i| i.step).collect::<Vec<_>>(), [10, 20]);
    assert_eq!(loaded.packings[0].packing, Packing { step: 10, ..p });
    // Truncated in the last chunk, the file still has the first packing, and the loss is reported.
    let file = directory.join("r_0.mcap");
    let bytes = std::fs::read(&file).unwrap();
    std::fs::write(&file, &bytes[..bytes.len() * 6 / 10]).unwrap();
    let loaded = load(&directory, &ImportOptions::default()).unwrap();
    assert_eq!((loaded.packings.len(), loaded.warnings.len()), (1, 1));
}
