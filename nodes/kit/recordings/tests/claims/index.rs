//! An index that contradicts the records is not believed; a file without one is no damaged file.

use crate::support::{START, attach, checked, file_with, of_bytes, post, remark, strings};
use grainlab_recordings::{Selection, WarningKind};
use mcap::WriteOptions;
use mcap::records::op;

/// A file of 40 messages in 8 chunks, without checksums.
fn file(options: WriteOptions) -> Vec<u8> {
    let options = options.compression(None).calculate_chunk_crcs(false).calculate_data_section_crc(false);
    file_with(options.calculate_summary_section_crc(false).chunk_size(None), |writer| {
        let channel = strings(writer, "/t");
        for n in 0..40 {
            post(writer, channel, START + n, b"\0\x01\0\0\x02\0\0\0v\0");
            if n % 5 == 4 {
                writer.flush().unwrap();
            }
        }
    })
}

/// Bytes of the bodies of the records with this opcode.
fn bodies(bytes: &[u8], opcode: u8) -> Vec<usize> {
    let (mut found, mut at) = (Vec::new(), 8);
    while at + 8 < bytes.len() {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap());
        found.extend((bytes[at] == opcode).then_some(at + 9));
        at += 9 + length as usize;
    }
    found
}

fn read(bytes: &[u8]) -> (usize, Vec<WarningKind>) {
    let recording = of_bytes(bytes);
    let from = Selection { start: Some(START + 5), ..Selection::default() };
    let later = recording.messages(&from).unwrap().count();
    assert_eq!(recording.info().messages, recording.messages(&Selection::default()).unwrap().count() as u64);
    (later, recording.warnings().into_iter().map(|w| w.kind).collect())
}

#[test]
fn an_index_that_contradicts_the_records_is_rebuilt_and_no_message_is_lost() {
    let whole = file(WriteOptions::new());
    assert_eq!(read(&whole), (35, vec![]));
    let [chunks, entries, statistics] =
        [op::CHUNK, op::CHUNK_INDEX, op::STATISTICS].map(|o| bodies(&whole, o));
    assert_eq!((chunks.len(), entries.len(), statistics.len()), (8, 8, 1));
    let zero = |at: usize| (at, vec![0; 16]);
    for (what, patches) in [
        ("an entry is missing", vec![(entries[3] - 9, vec![0x90])]),
        (
            "an entry points at another chunk",
            vec![(entries[1] + 16, (chunks[0] as u64 - 9).to_le_bytes().into())],
        ),
        ("an entry has other times", vec![zero(entries[2])]),
        ("a chunk and its entry have other times", vec![zero(chunks[2]), zero(entries[2])]),
        ("no times", chunks.iter().chain(&entries).map(|at| zero(*at)).collect()),
        ("an entry names another channel", vec![(entries[4] + 36, vec![9])]),
        ("statistics", vec![(statistics[0], 999u64.to_le_bytes().into())]),
    ] {
        let mut bytes = whole.clone();
        for (at, new) in patches {
            bytes[at..at + new.len()].copy_from_slice(&new);
        }
        assert_eq!(read(&bytes), (35, vec![WarningKind::NoIndex]), "{what}");
        let text = of_bytes(&bytes).warnings()[0].to_string();
        assert!(
            text.contains("the index is wrong (") && text.ends_with("rebuilt from the records"),
            "{text}"
        );
    }
}

/// The reason why the index of a file with these bytes is rebuilt.
fn reason(bytes: &[u8]) -> String {
    let recording = of_bytes(bytes);
    assert_eq!(recording.messages(&Selection::default()).unwrap().count(), 40);
    let [warning] = &recording.warnings()[..] else { panic!("{:?}", recording.warnings()) };
    assert_eq!(warning.kind, WarningKind::NoIndex);
    warning.detail.clone()
}

/// Without lists of messages, only the chunk itself has their times.
#[test]
fn a_message_outside_the_times_that_the_index_states_for_its_chunk_is_named_when_it_is_read() {
    let mut bytes = file(WriteOptions::new().emit_message_indexes(false));
    assert_eq!(read(&bytes), (35, vec![]));
    let (chunks, entries) = (bodies(&bytes, op::CHUNK), bodies(&bytes, op::CHUNK_INDEX));
    for at in [chunks[2], entries[2]] {
        bytes[at..at + 8].copy_from_slice(&(START + 11).to_le_bytes());
    }
    let (found, warnings) = read(&bytes);
    assert_eq!((found, warnings), (35, vec![WarningKind::Inconsistent]));
    let text = checked(&of_bytes(&bytes));
    assert!(text.contains("is not within the times that the index states for its chunk"), "{text}");
}

#[test]
fn counts_in_the_statistics_that_contradict_each_other_or_the_records_are_named_with_both_numbers() {
    let whole = file(WriteOptions::new());
    let statistics = bodies(&whole, op::STATISTICS)[0];
    let with = |at: usize, value: u8| {
        let mut bytes = whole.clone();
        bytes[statistics + at] = value;
        reason(&bytes)
    };
    assert_eq!(with(0, 41), "41 messages by its statistics, 40 by the records");
    // Behind the counts of the whole file and two times comes the length of the counts by channel.
    assert_eq!(with(48, 41), "40 messages by its statistics, 41 by its counts of each channel");
    assert_eq!(with(14, 1), "1 stored file by its statistics, 0 in the file");
    assert_eq!(with(18, 2), "2 metadata records by its statistics, 0 in the file");
    let mut two = whole.clone();
    // The second half of the messages is on a channel that is not declared, and the statistics know only the first channel.
    for list in bodies(&whole, op::MESSAGE_INDEX).into_iter().skip(4) {
        two[list] = 2;
    }
    assert_eq!(reason(&two), "40 messages on channel 1 by its statistics, 20 by the records");
}

#[test]
fn entries_of_stored_files_and_metadata_that_contradict_the_file_are_not_believed() {
    let whole = file_with(WriteOptions::new().calculate_summary_section_crc(false), |writer| {
        for name in ["a", "b"] {
            attach(writer, name, [1; 2], b"x");
            remark(writer, "m", "k", "v");
        }
    });
    let read = |at: usize, value: u8| {
        let mut bytes = whole.clone();
        bytes[at] = value;
        let recording = of_bytes(&bytes);
        assert_eq!(
            (recording.info().attachments, recording.stored_files().len()),
            (vec!["a".into(), "b".into()], 2)
        );
        recording.warnings().into_iter().map(|w| w.detail).collect::<String>()
    };
    let [files, records] = [op::ATTACHMENT_INDEX, op::METADATA_INDEX].map(|o| bodies(&whole, o));
    assert_eq!(read(files[1], whole[files[1]]), "", "unchanged");
    assert!(read(files[1], whole[files[0]]).starts_with("it lacks the stored file \"b\" at byte "));
    assert!(read(records[0], whole[records[1]]).starts_with("it lacks the metadata record \"m\" at byte "));
    // An entry that is no longer one of them.
    assert!(read(files[1] - 9, 0x90).starts_with("it lacks the stored file \"b\""));
}

#[test]
fn a_check_names_lists_of_messages_and_times_of_chunks_that_are_not_those_of_the_messages() {
    let whole = file(WriteOptions::new());
    assert_eq!(of_bytes(&whole).check().warnings, []);
    let faults = |at: usize| {
        let mut bytes = whole.clone();
        bytes[at] ^= 1;
        checked(&of_bytes(&bytes))
    };
    let lists = faults(bodies(&whole, op::MESSAGE_INDEX)[1] + 6 + 8);
    assert!(lists.contains("is not that of the chunk before it"), "{lists}");
    let times = faults(bodies(&whole, op::CHUNK)[1]);
    assert!(times.contains("its header states"), "{times}");
}

#[test]
fn a_file_without_an_index_is_read_to_its_end_and_is_not_damaged() {
    let without = || WriteOptions::new().emit_summary_records(false).emit_summary_offsets(false);
    let no_entries = WriteOptions::new().emit_chunk_indexes(false);
    for options in
        [without(), without().use_chunks(false), WriteOptions::new().emit_statistics(false), no_entries]
    {
        let bytes = file(options);
        assert_eq!(read(&bytes), (35, vec![]));
        let recording = of_bytes(&bytes);
        assert!(
            recording.is_without_index()
                && recording.info().complete
                && recording.check().warnings.is_empty()
        );
        assert!(recording.info().to_string().contains("which MCAP allows"));
        assert!(of_bytes(&bytes[..bytes.len() - 8]).warnings().len() == 1, "the end magic is not optional");
    }
    assert!(!of_bytes(&file(WriteOptions::new().use_chunks(false))).is_without_index());
}
