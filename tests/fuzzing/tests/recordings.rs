//! MCAP files: reading, checking, recovering.

use fuzzing::{Counting, Target};
use grainlab_msgs::{Guid, msg, to_cdr, topics};
use grainlab_recordings::import::ImportOptions;
use grainlab_recordings::{Incoming, Recording, RunWriter, Selection, TopicSpec, WriterOptions, recover};
use mcap::records::{MessageHeader, Metadata};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A recording with several chunks, attachments and metadata, and the same truncated.
fn seeds(folder: &Path) -> Vec<Vec<u8>> {
    let specs = [topics::PACKING, topics::STRESS].map(|t| TopicSpec::of_contract(&t, &t.absolute_name()));
    let options = WriterOptions { chunk_size: 1 << 10, ..WriterOptions::default() };
    let mut run = RunWriter::create(folder, "r", &specs, options).unwrap();
    run.attach("scene.toml", "application/toml", b"name = 'x'").unwrap();
    run.set_metadata("seed", "7");
    for n in 1..60i64 {
        let (topic, payload) = match n % 20 {
            0 => ("/packing", to_cdr(&msg::Packing { step: n as u64, ..Default::default() })),
            _ => ("/stress", to_cdr(&msg::Stress { sequence: n as u64, ..Default::default() })),
        };
        let receive_time = 1_000_000 * n as u64;
        let sample =
            Incoming { guid: Guid([1; 16]), sequence: n, source_time: None, receive_time, payload: &payload };
        run.write(topic, &sample).unwrap();
    }
    let file = run.finish().unwrap().file;
    let whole = std::fs::read(file).unwrap();
    let cut = whole[..whole.len() / 2].to_vec();
    vec![whole, cut, unchunked(&Recording::open(folder).unwrap())]
}

/// The messages of a recording outside chunks, and an attachment and metadata.
fn unchunked(recording: &Recording) -> Vec<u8> {
    let options = mcap::WriteOptions::new().use_chunks(false).profile("ros2");
    let mut writer = options.create(std::io::Cursor::new(Vec::new())).unwrap();
    for file in recording.stored_files() {
        let (name, media_type, data) = (file.name, file.media_type, file.bytes.into());
        let attachment =
            mcap::Attachment { log_time: file.time, create_time: file.created, name, media_type, data };
        writer.attach(&attachment).unwrap();
    }
    for message in recording.messages(&Selection::default()).unwrap() {
        let c = &message.channel;
        let schema = writer.add_schema(&c.ros_type, &c.schema_encoding, &c.schema).unwrap();
        let channel_id = writer.add_channel(schema, &c.topic, &c.message_encoding, &c.metadata).unwrap();
        let (sequence, log_time, publish_time) = (message.sequence, message.log_time, message.publish_time);
        let header = MessageHeader { channel_id, sequence, log_time, publish_time };
        writer.write_to_known_channel(&header, &message.payload).unwrap();
    }
    let metadata = BTreeMap::from([("seed".to_owned(), "7".to_owned())]);
    writer.write_metadata(&Metadata { name: "grainlab".to_owned(), metadata }).unwrap();
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

/// The bound stated in `grainlab_recordings::reader`, plus the index of the file.
const MEMORY: (usize, usize) = (384 << 20, 64 + 64);

#[test]
fn a_recording_gives_messages_or_warnings() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fuzz.mcap");
    Target {
        name: "mcap",
        seeds: seeds(&folder.path().join("r")),
        words: &["grainlab", "zstd", "lz4", "ros2", "rosbag2"],
        memory: MEMORY,
        decode: &mut |bytes| {
            std::fs::write(&path, bytes).unwrap();
            let Ok(recording) = Recording::open(&path) else { return };
            for message in recording.messages(&Selection::default()).unwrap() {
                drop(message);
            }
            let _ = (recording.info().to_string(), recording.stored_files(), recording.ledger());
            let _ = recording.check();
            let mut take = |_| ControlFlow::Continue(());
            let _ = grainlab_recordings::import::recording::each(
                &recording,
                &ImportOptions::default(),
                &mut take,
            );
        },
    }
    .run();
}

#[test]
fn a_recovery_gives_a_sound_file_with_the_same_messages_or_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fuzz.mcap");
    Target {
        name: "recover",
        seeds: seeds(&folder.path().join("r")),
        words: &["grainlab", "zstd", "ros2"],
        memory: MEMORY,
        decode: &mut |bytes| {
            std::fs::write(&path, bytes).unwrap();
            let count = |path: &Path| {
                Recording::open(path).unwrap().messages(&Selection::default()).unwrap().count() as u64
            };
            let before = Recording::open(&path).is_ok().then(|| count(&path));
            if let Ok(done) = recover(&path) {
                assert_eq!(Some(done.files[0].messages), before);
                assert_eq!(count(&path), done.files[0].messages);
                assert!(!recover(&path).unwrap().changed(), "a second time changes nothing");
            }
            for entry in std::fs::read_dir(folder.path()).unwrap().flatten() {
                let name = entry.file_name().to_string_lossy().into_owned();
                assert!(!name.ends_with(".recovering"), "{name} is left behind");
                if name.contains(".orig") {
                    std::fs::remove_file(entry.path()).unwrap();
                }
            }
        },
    }
    .run();
}
