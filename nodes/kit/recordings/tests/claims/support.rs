//! A small run, written like by a recorder; files of other programs; and what is read of either.

use std::fmt::Debug;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::time::Duration;

use grainlab_core::{Mat3, Material};
use grainlab_msgs::builtin_interfaces::Time;
use grainlab_msgs::topics::TOPICS;
use grainlab_msgs::{Guid, Topic, msg, rosgraph_msgs, stamp, std_msgs, to_cdr};
use grainlab_recordings::import::{ImportError, ImportOptions};
use grainlab_recordings::{Finished, Incoming, Recording, RunWriter, Selection, TopicSpec, WriterOptions};
use mcap::WriteOptions;
use mcap::records::MessageHeader;

pub(crate) const START: u64 = 1_700_000_000_000_000_000;
pub(crate) const SIMULATOR: Guid = Guid([7; 16]);
pub(crate) const ROBOT: Guid = Guid([9; 16]);

pub(crate) fn contract() -> Vec<TopicSpec> {
    let row = |t: &Topic| TopicSpec::of_contract(t, &t.absolute_name());
    TOPICS.iter().map(row).collect()
}

pub(crate) fn stress(n: u64) -> Vec<u8> {
    let header = std_msgs::Header { stamp: stamp(n as f64 * 1e-3), frame_id: "cell".into() };
    to_cdr(&msg::Stress { header, sequence: n, step: 10 * n, ..Default::default() })
}

pub(crate) fn clock(n: u64) -> Vec<u8> {
    to_cdr(&rosgraph_msgs::Clock { clock: Time { sec: 1_000_000_000, nanosec: n as u32 } })
}

/// Small chunks, so that a short file has many.
pub(crate) fn options() -> WriterOptions {
    WriterOptions { chunk_size: 4 << 10, flush_interval: Duration::from_secs(60), ..WriterOptions::default() }
}

pub(crate) fn sample<'a>(guid: Guid, sequence: i64, time: u64, payload: &'a [u8]) -> Incoming<'a> {
    Incoming { guid, sequence, source_time: Some(time.saturating_sub(30_000)), receive_time: time, payload }
}

/// Writes `count` stress messages, a clock message with every tenth, a latched packing at 100, and two
/// attachments.
pub(crate) fn write_run(directory: &Path, count: u64) -> Finished {
    let name = directory.file_name().unwrap().to_str().unwrap();
    let mut run = RunWriter::create(directory, name, &contract(), options()).unwrap();
    run.attach("demo.toml", "application/toml", b"name = \"demo\"\n").unwrap();
    run.set_metadata("seed", "7");
    run.ledger_mut().name(SIMULATOR, "/dem_simulator");
    for n in 1..=count {
        let time = START + n * 1_000_000;
        run.write("/stress", &sample(SIMULATOR, n as i64, time, &stress(n))).unwrap();
        if n % 10 == 0 {
            run.write("/clock", &sample(SIMULATOR, (n / 10) as i64, time, &clock(n))).unwrap();
        }
        if n == 100 {
            let header = std_msgs::Header { stamp: stamp(0.1), frame_id: "cell".into() };
            let packing = to_cdr(&msg::Packing { header, step: 1000, ..Default::default() });
            run.write("/packing", &sample(SIMULATOR, 1, time, &packing)).unwrap();
        }
    }
    run.ledger_mut().report("/stress", SIMULATOR, count);
    run.attach("late.txt", "text/plain", b"last words").unwrap();
    run.finish().unwrap()
}

pub(crate) fn run_in(root: &tempfile::TempDir, count: u64) -> (PathBuf, Vec<u8>) {
    let directory = root.path().join("demo-7-1");
    let finished = write_run(&directory, count);
    let bytes = std::fs::read(&finished.file).unwrap();
    (directory, bytes)
}

/// A recording in one file with these bytes.
pub(crate) fn of_bytes(bytes: &[u8]) -> Recording {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), bytes).unwrap();
    Recording::open(file.path()).unwrap()
}

pub(crate) fn open(path: &Path) -> Recording {
    Recording::open(path).unwrap()
}

/// Topic, sequence, log time, time of publishing and bytes of a message.
pub(crate) type Said = (String, u32, u64, u64, Vec<u8>);

pub(crate) fn said(recording: &Recording) -> Vec<Said> {
    let messages = recording.messages(&Selection::default()).unwrap();
    messages
        .map(|m| (m.channel.topic.clone(), m.sequence, m.log_time, m.publish_time, m.payload.to_vec()))
        .collect()
}

/// The faults that were found so far, a line each.
pub(crate) fn faults(recording: &Recording) -> String {
    recording.warnings().iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

/// The faults that a check finds, a line each.
pub(crate) fn checked(recording: &Recording) -> String {
    recording.check();
    faults(recording)
}

pub(crate) type Writer = mcap::Writer<Cursor<Vec<u8>>>;

/// The bytes of a file with what `fill` adds.
pub(crate) fn file_with(options: WriteOptions, fill: impl FnOnce(&mut Writer)) -> Vec<u8> {
    let mut writer = options.compression_threads(0).create(Cursor::new(Vec::new())).unwrap();
    fill(&mut writer);
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

/// Declares a topic of this type, with a definition in ROS 2's language.
pub(crate) fn declare(writer: &mut Writer, topic: &str, ros_type: &str, definition: &str) -> u16 {
    let schema = writer.add_schema(ros_type, "ros2msg", definition.as_bytes()).unwrap();
    writer.add_channel(schema, topic, "cdr", &Default::default()).unwrap()
}

/// Declares a topic of strings.
pub(crate) fn strings(writer: &mut Writer, topic: &str) -> u16 {
    declare(writer, topic, "std_msgs/msg/String", "string data\n")
}

/// Writes a message of this time.
pub(crate) fn post(writer: &mut Writer, channel_id: u16, log_time: u64, payload: &[u8]) {
    let header = MessageHeader { channel_id, sequence: 0, log_time, publish_time: log_time };
    writer.write_to_known_channel(&header, payload).unwrap();
}

pub(crate) fn attach(writer: &mut Writer, name: &str, [log_time, create_time]: [u64; 2], data: &[u8]) {
    let (name, media_type) = (name.to_owned(), "text/plain".to_owned());
    writer.attach(&mcap::Attachment { log_time, create_time, name, media_type, data: data.into() }).unwrap();
}

/// Writes a metadata record with one pair.
pub(crate) fn remark(writer: &mut Writer, name: &str, key: &str, value: &str) {
    let metadata = [(key.to_owned(), value.to_owned())].into();
    writer.write_metadata(&mcap::records::Metadata { name: name.to_owned(), metadata }).unwrap();
}

/// A file of `tests/golden`.
pub(crate) fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/golden").join(name)
}

/// Grains of glass, of a file that does not say so.
pub(crate) fn glass() -> ImportOptions {
    ImportOptions::of_grains(&Material::GLASS, 0.1)
}

/// Grains of glass in a cube.
pub(crate) fn in_cube(edge: f64) -> ImportOptions {
    ImportOptions { cell: Some(Mat3::identity() * edge), ..glass() }
}

/// Fails unless the text has all of these words.
#[track_caller]
pub(crate) fn assert_says(text: &str, words: &[&str]) {
    for words in words {
        assert!(text.contains(words), "{words}: {text}");
    }
}

/// Fails unless each change of the text, from the first words to the second ones, is refused with the third.
#[track_caller]
pub(crate) fn assert_refused<T: Debug>(
    text: &str,
    changes: &[(&str, &str, &str)],
    read: impl Fn(&str) -> Result<T, ImportError>,
) {
    for (from, to, expected) in changes {
        assert!(text.contains(from), "{from}");
        let error = read(&text.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.contains(expected), "{to}: {error}");
    }
}
