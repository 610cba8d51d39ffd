//! Damaged and foreign files: read as far as possible, with named faults, never a panic.

use std::path::Path;

use crate::support::{of_bytes, run_in};
use grainlab_recordings::{Recording, Selection, WarningKind};

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

#[test]
fn a_flipped_bit_in_a_chunk_costs_that_chunk_and_is_named() {
    let root = tempfile::tempdir().unwrap();
    let (_, bytes) = run_in(&root, 2000);
    let (whole, _) = read(&bytes);
    let (mut damaged, mut undamaged) = (0, 0);
    for at in (1000..bytes.len()).step_by(211) {
        let mut copy = bytes.clone();
        copy[at] ^= 1 << (at % 8);
        let (found, warnings) = read(&copy);
        // No false message is returned: the messages are those written, in order, with one gap.
        let missing = whole.len() - found.len();
        let head = found.iter().zip(&whole).take_while(|(a, b)| a == b).count();
        assert_eq!(found[head..], whole[head + missing..], "bit flipped at {at}");
        assert!(missing < 400, "bit flipped at {at} costs {missing} messages");
        assert_eq!(
            missing > 0,
            warnings.contains(&WarningKind::DamagedChunk),
            "bit flipped at {at}: {warnings:?}"
        );
        if missing > 0 {
            damaged += 1
        } else {
            undamaged += 1
        }
        let recording = of_bytes(&copy);
        assert!(!recording.check().warnings.is_empty(), "bit flipped at {at} goes unnoticed");
    }
    assert!(damaged > 20 && undamaged > 5, "{damaged} {undamaged}");
}

#[test]
fn a_truncated_file_with_a_flipped_bit_still_reads() {
    let root = tempfile::tempdir().unwrap();
    let (_, bytes) = run_in(&root, 1000);
    let cut = bytes.len() * 3 / 4;
    for at in (8..cut).step_by(173) {
        let mut copy = bytes[..cut].to_vec();
        copy[at] ^= 1 << (at % 8);
        let (_, warnings) = read(&copy);
        assert!(!warnings.is_empty());
    }
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
fn false_lengths_do_not_exhaust_memory() {
    let root = tempfile::tempdir().unwrap();
    let (_, bytes) = run_in(&root, 100);
    // Every eight bytes in turn become a huge length; reading must stay fast and need little memory.
    for at in (8..bytes.len().min(4000)).step_by(5).chain((bytes.len() - 2000..bytes.len() - 8).step_by(5)) {
        let mut copy = bytes.clone();
        copy[at..at + 8].copy_from_slice(&(u64::MAX / 3).to_le_bytes());
        let _ = read(&copy);
    }
}

#[test]
fn a_topic_that_is_not_there_is_answered_with_those_that_are() {
    let root = tempfile::tempdir().unwrap();
    let (_, bytes) = run_in(&root, 10);
    let recording = of_bytes(&bytes);
    let error = recording.messages(&Selection::topics(["stresses"])).err().unwrap().to_string();
    assert!(error.contains("/stress,") && error.contains("stresses"), "{error}");
}

/// A file of `chunks` chunks at the same time, each with one message of `bytes` zeros.
fn bomb(chunks: u32, bytes: usize) -> Vec<u8> {
    let mut writer = mcap::WriteOptions::new()
        .compression_threads(0)
        .chunk_size(None)
        .create(std::io::Cursor::new(Vec::new()))
        .unwrap();
    let schema = writer.add_schema("grainlab_msgs/msg/Stress", "ros2msg", b"uint8 x").unwrap();
    let channel = writer.add_channel(schema, "/stress", "cdr", &Default::default()).unwrap();
    let zeros = vec![0; bytes];
    for sequence in 0..chunks {
        for log_time in [1, 2] {
            let header =
                mcap::records::MessageHeader { channel_id: channel, sequence, log_time, publish_time: 1 };
            writer
                .write_to_known_channel(&header, if log_time == 1 { &zeros } else { &[0, 1, 0, 0] })
                .unwrap();
        }
        writer.flush().unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

#[test]
fn a_small_chunk_with_a_stated_size_of_a_hundred_megabytes_is_refused() {
    let bytes = bomb(1, 100 << 20);
    assert!(bytes.len() < 20_000, "{}", bytes.len());
    let (found, warnings) = read(&bytes);
    assert!(found.is_empty() && warnings == [WarningKind::DamagedChunk], "{warnings:?}");
    // Within the limits, recordings of any size are read completely.
    let (found, warnings) = read(&bomb(2, 20 << 20));
    assert_eq!((found.len(), warnings), (4, vec![]));
}

#[test]
fn chunks_that_claim_the_same_time_are_not_all_in_memory_together() {
    let recording = of_bytes(&bomb(20, 60 << 20));
    let mut held = Vec::new();
    let mut messages = recording.messages(&Selection::default()).unwrap();
    held.extend(messages.by_ref().take(1));
    // Twenty chunks of sixty megabytes begin at one time; a quarter of a gigabyte may be in memory at once.
    let large: usize = held.iter().chain(messages.collect::<Vec<_>>().iter()).map(|m| m.payload.len()).sum();
    assert!(large <= 320 << 20, "{large}");
    assert!(recording.warnings().iter().all(|w| w.kind == WarningKind::DamagedChunk));
    assert!(recording.warnings().len() >= 14, "{:?}", recording.warnings().len());
}

mod arbitrary_bytes {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]
        #[test]
        fn never_panic(body in proptest::collection::vec(any::<u8>(), 0..400), opcode in 0u8..18) {
            let mut bytes = b"\x89MCAP0\r\n".to_vec();
            bytes.push(opcode);
            bytes.extend((body.len() as u64).to_le_bytes());
            bytes.extend(&body);
            let _ = read(&bytes);
            bytes.extend(b"\x89MCAP0\r\n");
            let _ = read(&bytes);
        }
    }
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
