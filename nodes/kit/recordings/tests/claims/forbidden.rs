//! What MCAP forbids is named, and what is read of it is said.

use crate::by_hand::{channel, channel_with, chunk, file, message, metadata, schema};
use crate::support::{faults, of_bytes, said};
use grainlab_recordings::Recording;

const STRING: &str = "std_msgs/msg/String";

fn topics(recording: &Recording) -> Vec<String> {
    said(recording).into_iter().map(|message| message.0).collect()
}

/// The records in the data section, and in a chunk.
fn both(times: [u64; 2], records: &[Vec<u8>]) -> [Recording; 2] {
    [file(records), file(&[chunk(times, records)])].map(|bytes| of_bytes(&bytes))
}

/// "Any two channel records sharing a common ID must be identical."
#[test]
fn a_channel_or_schema_that_is_declared_twice_with_different_content_is_a_fault_and_the_first_is_used() {
    let start = [schema(1, STRING), channel(1, 1, "/a"), message(1, 5)];
    for (second, fault) in [
        (channel(1, 1, "/b"), "channel 1 is declared twice, as \"/a\" and as \"/b\""),
        (channel(1, 0, "/a"), "channel 1 is declared twice, both times as \"/a\""),
        (schema(1, "my/msg/B"), "schema 1 is declared twice, as \"std_msgs/msg/String\" and as \"my/msg/B\""),
    ] {
        for recording in both([5, 6], &[&start[..], &[second, message(1, 6)]].concat()) {
            assert_eq!(topics(&recording), ["/a", "/a"]);
            assert_eq!(recording.info().messages, 2);
            let found = recording.warnings();
            assert!(matches!(&found[..], [one] if one.detail.contains(fault)), "{found:?}");
            assert_eq!(found, recording.check().warnings);
        }
    }
    for recording in both([5, 6], &[&start[..], &start[..2], &[message(1, 6)]].concat()) {
        assert_eq!((topics(&recording).len(), recording.check().warnings), (2, vec![]), "repeated as it was");
    }
}

/// "A Schema record with an id of zero is invalid and should be ignored by readers."
#[test]
fn a_schema_with_the_id_0_is_ignored_and_a_check_names_it() {
    for recording in both([5, 5], &[schema(0, STRING), channel(1, 0, "/a"), message(1, 5)]) {
        assert_eq!((topics(&recording).len(), faults(&recording)), (1, String::new()));
        assert_eq!(recording.channels()[0].ros_type, "");
        assert!(recording.check().warnings[0].detail.contains("has the id 0"));
    }
}

/// "A Channel record must occur at least once in the file prior to any message referring to its channel ID", and so a schema.
#[test]
fn messages_before_their_channel_and_channels_before_their_schema_are_read_and_a_check_names_them() {
    let early = [schema(1, STRING), message(1, 4), message(1, 5), channel(1, 1, "/a"), message(1, 6)];
    for recording in both([4, 6], &early) {
        assert_eq!((topics(&recording).len(), recording.info().messages), (3, 3));
        assert_eq!(faults(&recording), "");
        let [fault] = &recording.check().warnings[..] else { panic!("one fault") };
        assert!(fault.detail.starts_with("2 messages on /a before the declaration"), "{fault}");
    }
    for recording in both([5, 5], &[channel(1, 1, "/a"), message(1, 5), schema(1, STRING)]) {
        assert_eq!((topics(&recording).len(), faults(&recording)), (1, String::new()));
        let [fault] = &recording.check().warnings[..] else { panic!("one fault") };
        assert!(fault.detail.contains("\"/a\" comes before its schema 1"), "{fault}");
    }
}

#[test]
fn a_channel_whose_schema_is_nowhere_is_left_out_and_named() {
    for recording in both([5, 5], &[channel(1, 7, "/a"), message(1, 5)]) {
        assert!(topics(&recording).is_empty());
        let found = faults(&recording);
        assert!(found.contains("names schema 7, which is missing: its messages are left out"), "{found}");
    }
}

/// "Attachment records must not appear within a chunk."
#[test]
fn a_record_that_no_chunk_may_contain_is_a_loss_and_no_end_of_the_file() {
    let end = crate::by_hand::record(mcap::records::op::DATA_END, &[0; 4]);
    let inside = [schema(1, STRING), channel(1, 1, "/a"), metadata("m", &[]), end, message(1, 5)];
    let recording = of_bytes(&file(&[chunk([5, 5], &inside), metadata("outside", &[])]));
    assert_eq!(recording.metadata_names().into_iter().collect::<Vec<_>>(), ["outside"]);
    assert_eq!(topics(&recording), ["/a"]);
    let found = faults(&recording);
    assert!(found.contains("type 0x0c in a chunk") && found.contains("type 0x0f in a chunk"), "{found}");
    let cut = file(&[chunk([5, 5], &inside)]);
    assert!(!of_bytes(&cut[..cut.len() - 50]).info().complete, "the end record is outside chunks");
}

#[test]
fn a_message_outside_the_times_of_its_chunk_is_a_fault_when_it_is_read() {
    let records = [schema(1, STRING), channel(1, 1, "/a"), message(1, 5)];
    let recording = of_bytes(&file(&[chunk([5, 5], &records)]));
    assert_eq!((topics(&recording).len(), faults(&recording)), (1, String::new()));
    let [fault] = &of_bytes(&file(&[chunk([6, 7], &records)])).check().warnings[..] else { panic!("one") };
    assert!(fault.detail.contains("its header states 6 to 7 ns"), "{fault}");
}

/// "A serialization which has duplicate keys may cause indeterminate decoding."
#[test]
fn a_key_that_metadata_has_twice_is_a_fault_and_the_last_value_is_used() {
    let twice = [["k", "1"], ["other", "x"], ["k", "2"]];
    for recording in both([5, 5], &[schema(1, STRING), channel_with(1, 1, "/a", &twice), message(1, 5)]) {
        assert_eq!(topics(&recording), ["/a"]);
        assert_eq!(recording.channels()[0].metadata["k"], "2");
        let [fault] = &recording.check().warnings[..] else { panic!("{:?}", recording.warnings()) };
        assert!(
            fault.detail.starts_with("the metadata of channel \"/a\" has the key \"k\" twice"),
            "{fault}"
        );
    }
    let recording = of_bytes(&file(&[metadata("vehicle", &twice)]));
    assert_eq!(recording.metadata("vehicle").unwrap()["k"], "2");
    let [fault] = &recording.check().warnings[..] else { panic!("{:?}", recording.warnings()) };
    assert!(fault.detail.starts_with("the metadata record \"vehicle\" has the key \"k\" twice"), "{fault}");
}
