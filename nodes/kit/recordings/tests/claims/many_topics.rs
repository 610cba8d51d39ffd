//! The time to read a recording grows in proportion to the number of its topics.

use crate::by_hand::HI;
use crate::support::{file_with, of_bytes, open, post};
use grainlab_recordings::copy::{CopyOptions, copy};
use grainlab_recordings::{PlayOptions, Player, Selection};
use mcap::WriteOptions;
use std::collections::BTreeMap;
use std::fs;
use std::time::{Duration, Instant};

const TOPICS: usize = 10_000;

/// A time that is proportional to the number of topics is a second of computing; one that grows with its square is minutes.
#[test]
fn ten_thousand_topics_are_read_checked_copied_and_played_in_seconds() {
    let root = tempfile::tempdir().unwrap();
    let latched = "- durability: 1\n  depth: 1\n".to_owned();
    let metadata = BTreeMap::from([("offered_qos_profiles".to_owned(), latched)]);
    let mut entries = String::new();
    let bytes = file_with(WriteOptions::new(), |writer| {
        let schema = writer.add_schema("std_msgs/msg/String", "ros2msg", b"string data\n").unwrap();
        for n in 0..TOPICS {
            let topic = format!("/t{n}");
            let channel = writer.add_channel(schema, &topic, "cdr", &metadata).unwrap();
            post(writer, channel, n as u64, HI);
            entries += &format!(
                "    - {{topic_metadata: {{name: {topic}, type: std_msgs/msg/String, serialization_format: cdr}}, message_count: 1}}\n"
            );
        }
    });
    fs::write(root.path().join("r_0.mcap"), bytes).unwrap();
    let text =
        "rosbag2_bagfile_information:\n  relative_file_paths: [r_0.mcap]\n  topics_with_message_count:\n";
    fs::write(root.path().join("metadata.yaml"), format!("{text}{entries}")).unwrap();

    let begin = Instant::now();
    let recording = open(root.path());
    let names: Vec<String> = recording.channels().iter().map(|c| c.topic.clone()).collect();
    let read = recording.messages(&Selection::topics(&names)).unwrap().count();
    assert_eq!((names.len(), read), (TOPICS, TOPICS));
    assert_eq!(recording.check().warnings, []);
    let options = CopyOptions { start: Some(TOPICS as u64 / 2), ..CopyOptions::default() };
    let copied = copy(&[recording], &root.path().join("copy"), &options).unwrap();
    assert_eq!((copied.messages, copied.latched), (TOPICS as u64, TOPICS as u64 / 2));
    let made = open(&root.path().join("copy"));
    let options = PlayOptions { exclude: names[1..].to_vec(), ..PlayOptions::default() };
    assert_eq!(Player::new(&made, &options).unwrap().channels().len(), 1);
    assert_eq!(Player::new(&made, &PlayOptions::default()).unwrap().channels().len(), TOPICS);
    let taken = begin.elapsed();
    assert!(taken < Duration::from_secs(60), "{taken:?}");
}

/// A channel for each publisher of one topic.
#[test]
fn thousands_of_publishers_of_one_topic_keep_their_channels_in_a_copy() {
    let root = tempfile::tempdir().unwrap();
    let bytes = file_with(WriteOptions::new(), |writer| {
        for n in 0..TOPICS {
            let metadata = BTreeMap::from([("publisher".to_owned(), n.to_string())]);
            writer.add_channel(0, "/tf", "cdr", &metadata).unwrap();
        }
    });
    let begin = Instant::now();
    let to = root.path().join("b.mcap");
    copy(&[of_bytes(&bytes)], &to, &CopyOptions::default()).unwrap();
    assert_eq!(open(&to).all_channels().count(), TOPICS);
    let taken = begin.elapsed();
    assert!(taken < Duration::from_secs(60), "{taken:?}");
}
