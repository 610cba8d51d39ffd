//! Damaged and foreign files: read as far as possible, with named faults, never a panic.

use std::path::Path;

use crate::support::{
    START, attach, checked, clock, contract, declare, faults, file_with, of_bytes, post, remark, run_in,
    stress,
};
use grainlab_recordings::{Recording, Selection, WarningKind};
use mcap::records::{MessageHeader, op};

fn read(bytes: &[u8]) -> (Vec<(String, u32)>, Vec<WarningKind>) {
    let recording = of_bytes(bytes);
    let messages = recording.messages(&Selection::default()).unwrap();
    let found = messages.map(|m| (m.channel.topic.clone(), m.sequence)).collect();
    let _ = (recording.stored_files(), recording.info().to_string(), recording.ledger());
    (found, recording.warnings().into_iter().map(|w| w.kind).collect())
}

#[test]
fn every_truncation_gives_the_messages_before_it() {
    let root = tempfile::tempdir().unwrap();
    let (_, bytes) = run_in(&root, 200);
    let (whole, warnings) = read(&bytes);
    assert!(warnings.is_empty());
    let mut last = 0;
    // Every offset near both ends, where the records are; every 97th between.
    let near_end = bytes.len() - 6000;
    for cut in (8..600).chain((600..near_end).step_by(97)).chain((near_end..bytes.len()).step_by(3)) {
        let (found, warnings) = read(&bytes[..cut]);
        assert_eq!(found, whole[..found.len()], "cut at {cut}");
        assert!(found.len() >= last, "cut at {cut} gives less than an earlier cut");
        last = found.len();
        let expected = [WarningKind::Truncated, WarningKind::NoIndex];
        assert!(warnings.len() == 1 && expected.contains(&warnings[0]), "cut at {cut}: {warnings:?}");
    }
    // If only the index is cut off, no message is missing.
    assert_eq!(last, whole.len());
}

/// A file as a recorder writes it, with the same bytes each time: a recorder stores the time in it.
fn same_bytes(count: u64) -> Vec<u8> {
    let options = mcap::WriteOptions::new().compression_level(1).profile("ros2").disable_seeking(true);
    file_with(options.chunk_size(Some(4 << 10)), |writer| {
        // Five channels, because the first bytes of the header, taken for a message, are of channel 4.
        let names = ["/stress", "/clock", "/packing", "/strain_rate", "/moduli"];
        let [stress_id, clock_id, ..] = names.map(|name| {
            let topic = contract().into_iter().find(|topic| topic.name == name).unwrap();
            declare(writer, name, &topic.ros_type, &topic.definition)
        });
        writer.flush().unwrap();
        attach(writer, "demo.toml", [1; 2], b"name = \"demo\"\n");
        for n in 1..=count {
            let log_time = START + n * 1_000_000;
            let mut write = |channel_id, sequence, payload: &[u8]| {
                let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
                writer.write_to_known_channel(&header, payload).unwrap();
            };
            write(stress_id, n as u32, &stress(n));
            if n % 10 == 0 {
                write(clock_id, n as u32 / 10, &clock(n));
            }
        }
        attach(writer, "late.txt", [1; 2], b"last words");
        remark(writer, "run", "seed", "7");
    })
}

/// Flips a bit; returns the number of messages that it costs. They are the messages of one chunk, which is named then, and only then.
fn flipped(bytes: &[u8], whole: &[(String, u32)], at: usize, bit: usize) -> usize {
    let mut copy = bytes.to_vec();
    copy[at] ^= 1 << bit;
    let (found, warnings) = read(&copy);
    let place = format!("bit {bit} of byte {at}: {}", faults(&of_bytes(&copy)));
    // No false message is returned: the messages are those written, in order, with one gap.
    let missing = whole.len() - found.len();
    let head = found.iter().zip(whole).take_while(|(a, b)| a == b).count();
    assert_eq!(found[head..], whole[head + missing..], "{place}");
    assert!(missing < 400, "{missing} messages are missing, {place}");
    assert_eq!(missing > 0, warnings.contains(&WarningKind::DamagedChunk), "{place}");
    assert!(!of_bytes(&copy).check().warnings.is_empty(), "unnoticed, {place}");
    missing
}

#[test]
fn a_flipped_bit_in_a_chunk_costs_that_chunk_and_is_named() {
    let bytes = same_bytes(2000);
    let (whole, warnings) = read(&bytes);
    assert_eq!((whole.len(), warnings), (2200, vec![]));
    let costs = (8..bytes.len()).step_by(211).map(|at| flipped(&bytes, &whole, at, at % 8));
    let (damaged, undamaged): (Vec<_>, Vec<_>) = costs.partition(|missing| *missing > 0);
    assert!(damaged.len() > 20 && undamaged.len() > 5, "{damaged:?} {undamaged:?}");
}

/// A record of another type than it had is told from what the index states of it: a list of messages that became a chunk is no chunk
/// that is lost, and a list that became a message is no message.
#[test]
fn a_flipped_bit_in_the_type_of_a_record_costs_no_message_but_those_of_a_chunk() {
    let bytes = same_bytes(300);
    let (whole, _) = read(&bytes);
    let (mut at, mut chunks) = (8, 0);
    while bytes[at] != op::FOOTER {
        let is_chunk = bytes[at] == op::CHUNK;
        for bit in 0..8 {
            let missing = flipped(&bytes, &whole, at, bit);
            assert!(missing == 0 || is_chunk, "{missing} messages for type 0x{:02x} at byte {at}", bytes[at]);
            chunks += usize::from(missing > 0);
        }
        at += 9 + u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
    }
    assert!(chunks >= 8 * 5, "{chunks}");
}

#[test]
fn a_hole_of_zeros_is_one_damaged_run_with_its_extent_and_the_number_of_its_records() {
    let mut bytes = same_bytes(2000);
    let (whole, _) = read(&bytes);
    let hole = bytes.len() / 4..bytes.len() / 2;
    bytes[hole.clone()].fill(0);
    let (found, _) = read(&bytes);
    let missing = whole.len() - found.len();
    let head = found.iter().zip(&whole).take_while(|(a, b)| a == b).count();
    assert!(missing > 100 && found[head..] == whole[head + missing..], "{missing} are missing");
    let warnings = of_bytes(&bytes).warnings();
    // The record in which the hole begins has lengths, which are wrong.
    let damaged =
        warnings.iter().filter(|w| w.kind == WarningKind::DamagedRecord && !w.detail.contains("lengths"));
    let [run] = damaged.collect::<Vec<_>>()[..] else { panic!("{} messages", warnings.len()) };
    let (others, end) =
        run.detail.split_once("so are ").unwrap().1.split_once(" more records up to byte ").unwrap();
    assert!(hole.contains(&(run.offset as usize)) && others.parse::<usize>().unwrap() > 10, "{run}");
    assert!(end.parse::<usize>().unwrap().abs_diff(hole.end) <= 9, "{run}");
}

#[test]
fn files_that_are_not_recordings_are_refused_with_a_reason() {
    let root = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| {
        let path = root.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let error = |path: &Path| Recording::open(path).unwrap_err().to_string();
    assert!(error(Path::new("/no/such/run")).starts_with("/no/such/run: "));
    assert!(error(root.path()).contains("contains no .mcap file"));
    for (name, bytes) in
        [("empty.mcap", &b""[..]), ("text.mcap", b"LAMMPS data file"), ("short.mcap", b"\x89MCAP")]
    {
        let error = error(&file(name, bytes));
        assert!(error.contains("is not an MCAP file") && error.contains(name), "{error}");
    }
    let (found, warnings) = read(b"\x89MCAP0\r\n");
    assert!(found.is_empty() && warnings == [WarningKind::Truncated]);
}

#[test]
fn a_topic_that_is_not_there_is_answered_with_those_that_are() {
    let root = tempfile::tempdir().unwrap();
    let (_, bytes) = run_in(&root, 10);
    let recording = of_bytes(&bytes);
    let error = recording.messages(&Selection::topics(["stresses"])).err().unwrap().to_string();
    assert!(error.contains("/stress,") && error.contains("stresses"), "{error}");
}

/// A file with a chunk of one message of `bytes` zeros.
fn zeros(bytes: usize) -> Vec<u8> {
    file_with(mcap::WriteOptions::new().chunk_size(None), |writer| {
        let channel = writer.add_channel(0, "/depth", "cdr", &Default::default()).unwrap();
        post(writer, channel, 1, &vec![0; bytes]);
    })
}

/// An empty depth image or map compresses ten thousandfold.
#[test]
fn a_chunk_of_a_hundred_megabytes_of_zeros_is_read() {
    let bytes = zeros(100_000_000);
    assert!(bytes.len() < 20_000, "{}", bytes.len());
    let recording = of_bytes(&bytes);
    let sizes: Vec<usize> =
        recording.messages(&Selection::default()).unwrap().map(|m| m.payload.len()).collect();
    assert_eq!((sizes, recording.warnings()), (vec![100_000_000], vec![]));
}

#[test]
fn a_chunk_that_states_more_than_a_gigabyte_is_refused_unless_it_is_large_itself() {
    let mut bytes = zeros(1000);
    let at = bytes.windows(8).position(|eight| eight == 1000u64.to_le_bytes()).map(|_| ());
    assert!(at.is_none(), "the size of a chunk is the size of its records");
    let chunk = bytes.iter().position(|byte| *byte == mcap::records::op::CHUNK).unwrap();
    let stated = chunk + 9 + 16;
    bytes[stated..stated + 8].copy_from_slice(&((1u64 << 30) + 1).to_le_bytes());
    let (found, warnings) = read(&bytes);
    assert!(found.is_empty() && warnings.contains(&WarningKind::DamagedChunk), "{warnings:?}");
    let text = checked(&of_bytes(&bytes));
    assert!(text.contains("at most 1073741824 are accepted"), "{text}");
}

#[test]
fn a_part_without_a_byte_is_named_and_the_other_parts_are_read() {
    let root = tempfile::tempdir().unwrap();
    let (directory, bytes) = run_in(&root, 100);
    let count = || {
        let recording = Recording::open(&directory).unwrap();
        let found = recording.messages(&Selection::default()).unwrap().count();
        (found, recording.warnings().into_iter().map(|w| w.kind).collect::<Vec<_>>())
    };
    let whole = count().0;
    std::fs::remove_file(directory.join("metadata.yaml")).unwrap();
    std::fs::write(directory.join("demo-7-1_1.mcap"), b"").unwrap();
    std::fs::write(directory.join("demo-7-1_2.mcap"), &bytes).unwrap();
    assert_eq!(count(), (2 * whole, vec![WarningKind::Truncated]));
    // The file alone is no recording.
    let alone = Recording::open(&directory.join("demo-7-1_1.mcap")).unwrap_err().to_string();
    assert!(alone.contains("is not an MCAP file: it has 0 bytes"), "{alone}");
}
