//! What follows the end of a recording in its file is named, and is read if it belongs to the recording.

use crate::by_hand::{HI, channel, file, message, record, schema};
use crate::support::{file_with, of_bytes, open, post, strings};
use grainlab_recordings::{Recording, Selection, Warning, WarningKind, recover};
use mcap::records::op;
use mcap::{MAGIC, WriteOptions};

const STRING: &str = "std_msgs/msg/String";

fn times(recording: &Recording) -> Vec<u64> {
    recording.messages(&Selection::default()).unwrap().map(|m| m.log_time).collect()
}

/// A file with a message of each of these times, in a chunk each.
fn written(options: WriteOptions, times: &[u64]) -> Vec<u8> {
    file_with(options, |writer| {
        let channel = strings(writer, "/a");
        for time in times {
            post(writer, channel, *time, HI);
            writer.flush().unwrap();
        }
    })
}

/// `cat a.mcap b.mcap > c.mcap`.
#[test]
fn a_recording_behind_another_one_in_its_file_is_named_with_the_byte_at_which_it_begins() {
    let plain = || WriteOptions::new().calculate_summary_section_crc(false);
    let without_index = || WriteOptions::new().emit_summary_records(false).emit_summary_offsets(false);
    for options in [WriteOptions::new, plain, without_index, || WriteOptions::new().use_chunks(false)] {
        let (one, two) = (written(options(), &[1, 2]), written(options(), &[3, 4, 5]));
        for both in [[&one[..], &two].concat(), [&one[..], &one].concat()] {
            let recording = of_bytes(&both);
            assert_eq!(times(&recording), [1, 2]);
            let [fault] = &recording.warnings()[..] else { panic!("{:?}", recording.warnings()) };
            assert_eq!((fault.kind, fault.offset), (WarningKind::AfterEnd, one.len() as u64));
            let text = fault.to_string();
            assert!(text.contains("another recording begins here") && text.contains("`tail -c +"), "{text}");
            assert_eq!(recording.check().warnings, std::slice::from_ref(fault));
        }
        let rest = of_bytes(&[&one[..], &two].concat()[one.len()..]);
        assert_eq!((times(&rest), rest.check().warnings), (vec![3, 4, 5], vec![]));
        let padded = of_bytes(&[&one[..], &[0; 512]].concat());
        let faults = padded.check().warnings;
        assert!(faults.len() == 1 && faults[0].detail.starts_with("512 bytes follow"), "{faults:?}");
    }
}

/// The index of the first byte after the end record of the data.
fn after_data(bytes: &[u8]) -> usize {
    let mut at = MAGIC.len();
    loop {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap());
        at += 9 + length as usize;
        if bytes[at - 9 - length as usize] == op::DATA_END {
            return at;
        }
    }
}

/// Inserts a message at byte `at`.
fn with_message(whole: &[u8], at: usize) -> Vec<u8> {
    [&whole[..at], &message(1, 2), &whole[at..]].concat()
}

#[test]
fn messages_between_the_end_record_of_the_data_and_the_summary_are_read_and_named() {
    let bare = file(&[schema(1, STRING), channel(1, 1, "/a"), message(1, 1)]);
    let whole =
        written(WriteOptions::new().calculate_summary_section_crc(false).emit_summary_offsets(false), &[1]);
    let at = after_data(&whole);
    let mut indexed = with_message(&whole, at);
    let summary_start = indexed.len() - MAGIC.len() - 20;
    let moved = at + message(1, 2).len();
    indexed[summary_start..summary_start + 8].copy_from_slice(&(moved as u64).to_le_bytes());
    let root = tempfile::tempdir().unwrap();
    for (n, (bytes, at)) in
        [(with_message(&bare, after_data(&bare)), after_data(&bare)), (indexed, at)].into_iter().enumerate()
    {
        let recording = of_bytes(&bytes);
        assert_eq!((times(&recording), recording.info().messages), (vec![1, 2], 2), "{n}");
        let named = |faults: &[Warning]| {
            faults.iter().any(|w| w.offset == at as u64 && w.detail.contains("follow the end record"))
        };
        assert!(named(&recording.warnings()) && named(&recording.check().warnings), "{n}");
        // A recovery writes a sound file.
        let path = root.path().join(format!("{n}.mcap"));
        std::fs::write(&path, &bytes).unwrap();
        recover(&path).unwrap();
        let made = open(&path);
        assert_eq!((times(&made), made.check().warnings), (vec![1, 2], vec![]), "{n}");
    }
}

/// They may be damaged records of the summary.
#[test]
fn messages_in_the_summary_or_after_the_footer_are_not_read_and_named() {
    let bare = file(&[schema(1, STRING), channel(1, 1, "/a"), message(1, 1)]);
    let indexed = |crc: bool| written(WriteOptions::new().calculate_summary_section_crc(crc), &[1]);
    for (n, (whole, at)) in [
        (bare.clone(), bare.len() - MAGIC.len()),
        (bare.clone(), bare.len()),
        (indexed(true), after_data(&indexed(true))),
        (indexed(false), after_data(&indexed(false))),
        (indexed(true), indexed(true).len() - MAGIC.len()),
    ]
    .into_iter()
    .enumerate()
    {
        let recording = of_bytes(&with_message(&whole, at));
        let is_named = |faults: &[Warning]| {
            let is_this = |w: &Warning| w.kind == WarningKind::AfterEnd && w.offset == at as u64;
            faults.iter().any(is_this)
        };
        assert_eq!(times(&recording), [1], "{n}");
        let (faults, checked) = (recording.warnings(), recording.check().warnings);
        assert!(is_named(&faults) && is_named(&checked), "{n}: {faults:?}");
    }
}

/// Later versions of MCAP and other programs may add records to the summary.
#[test]
fn a_record_that_mcap_does_not_define_in_the_summary_is_no_fault() {
    let whole = file(&[schema(1, STRING), channel(1, 1, "/a"), message(1, 1)]);
    let at = after_data(&whole);
    let recording = of_bytes(&[&whole[..at], &record(0x42, b"new"), &whole[at..]].concat());
    assert_eq!((times(&recording), recording.check().warnings), (vec![1], vec![]));
}
