//! A small run, written like by a recorder.

use std::path::{Path, PathBuf};
use std::time::Duration;

use grainlab_msgs::builtin_interfaces::Time;
use grainlab_msgs::topics::TOPICS;
use grainlab_msgs::{Guid, Topic, msg, rosgraph_msgs, stamp, std_msgs, to_cdr};
use grainlab_recordings::{Finished, Incoming, Recording, RunWriter, TopicSpec, WriterOptions};

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
