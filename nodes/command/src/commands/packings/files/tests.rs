use super::*;
use grainlab_msgs::{Guid, msg, to_cdr, topics};
use grainlab_recordings::{Incoming, RunWriter, TopicSpec, WriterOptions};

/// A recording of one invalid packing message: the error and the exit code show whether it was reached.
fn recording(folder: &Path) -> PathBuf {
    let topic = TopicSpec::of_contract(&topics::PACKING, "/packing");
    let mut run = RunWriter::create(folder, "r", &[topic], WriterOptions::default()).unwrap();
    let payload = to_cdr(&msg::Packing::default());
    let sample =
        Incoming { guid: Guid([1; 16]), sequence: 1, source_time: None, receive_time: 5, payload: &payload };
    run.write("/packing", &sample).unwrap();
    run.finish().unwrap().file
}

#[test]
fn a_damaged_chunk_of_the_packing_is_named_and_is_data_loss() {
    let folder = tempfile::tempdir().unwrap();
    let good = std::fs::read(recording(&folder.path().join("r"))).unwrap();
    let damaged = folder.path().join("damaged.mcap");
    let outcome = |bytes: &[u8]| {
        std::fs::write(&damaged, bytes).unwrap();
        let options = ImportOptions { topic: Some("packing".into()), ..ImportOptions::default() };
        read(&damaged, &options, &mut |_| ControlFlow::Continue(()))
    };
    let (_, exit) = outcome(&good);
    assert_eq!(exit, Exit::Failure, "undamaged, the message is read and found to be no packing");
    // The chunk with the message is the last record of its kind.
    let (mut at, mut chunk) = (8, 0);
    while good[at] != 0x0f {
        chunk = if good[at] == 0x06 { at } else { chunk };
        at += 9 + u64::from_le_bytes(good[at + 1..at + 9].try_into().unwrap()) as usize;
    }
    // The chunk's opcode, its length, its header and the start of its content.
    for bit in 0..8 * 70 {
        let mut bytes = good.clone();
        bytes[chunk + bit / 8] ^= 1 << (bit % 8);
        let (complaints, exit) = outcome(&bytes);
        let text = complaints.join("\n");
        // A chunk with a slightly larger length or other times is read all the same.
        let read_all_the_same = text.contains("message 1 on /packing");
        assert!(exit == Exit::DataLoss || read_all_the_same, "bit {bit}: {text}");
        let named = text.contains(&format!("byte {chunk}")) || text.contains("checksum");
        assert!(named || read_all_the_same, "bit {bit}: {text}");
    }
}
