//! MCAP files: reading, checking, recovering.

use fuzzing::{Counting, Target};
use grainlab_msgs::{Guid, msg, to_cdr, topics};
use grainlab_recordings::copy::{CopyOptions, Preset, Select, copy};
use grainlab_recordings::import::ImportOptions;
use grainlab_recordings::{Incoming, Recording, RunWriter, Selection, TopicSpec, WriterOptions, recover};
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
    let unchunked = folder.join("unchunked.mcap");
    let recording = Recording::open(folder).unwrap();
    let options = CopyOptions::of_preset(Preset::FastWrite);
    copy(&[recording], &Select::default(), &unchunked, &options).unwrap();
    vec![whole, cut, std::fs::read(unchunked).unwrap()]
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
