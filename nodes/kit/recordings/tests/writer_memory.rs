//! Memory of a recorder that runs for hours.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::{Duration, Instant};

use grainlab_msgs::topics::TOPICS;
use grainlab_msgs::{Guid, Topic};
use grainlab_recordings::{Incoming, Recording, RunWriter, Selection, TopicSpec, WriterOptions};

struct Counting;

static NOW: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

fn add(bytes: usize) {
    PEAK.fetch_max(NOW.fetch_add(bytes, Relaxed) + bytes, Relaxed);
}

// SAFETY: every call is passed unchanged to the allocator of the system.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        add(layout.size());
        // SAFETY: the caller guarantees the conditions of `System`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as above; `pointer` came from `System`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Chunks per second of a recorder at full speed, each with messages of every topic.
const CHUNKS_A_SECOND: f64 = 2.5;

/// Records `hours` in simulated time; returns bytes in memory after each quarter of an hour.
fn record(directory: &std::path::Path, options: WriterOptions, hours: f64) -> Vec<usize> {
    let topics: Vec<&Topic> = TOPICS.iter().filter(|t| t.is_recorded()).take(12).collect();
    let specs: Vec<TopicSpec> =
        topics.iter().map(|t| TopicSpec::of_contract(t, &t.absolute_name())).collect();
    assert_eq!(specs.len(), 12);
    let mut run = RunWriter::create(directory, "long", &specs, options).unwrap();
    let begin = Instant::now();
    let chunks = (hours * 3600.0 * CHUNKS_A_SECOND) as i64;
    let mut memory = Vec::new();
    for n in 1..=chunks {
        let payload = [&[0, 1, 0, 0][..], &n.to_le_bytes()].concat();
        for spec in &specs {
            let sample = Incoming {
                guid: Guid([7; 16]),
                sequence: n,
                source_time: None,
                receive_time: n as u64 * 400_000_000,
                payload: &payload,
            };
            run.write(&spec.name, &sample).unwrap();
        }
        run.tick(begin + Duration::from_secs_f64((n + 1) as f64 / CHUNKS_A_SECOND)).unwrap();
        if n % (900.0 * CHUNKS_A_SECOND) as i64 == 0 {
            memory.push(NOW.load(Relaxed));
        }
    }
    let finished = run.finish().unwrap();
    assert_eq!(finished.messages, 12 * chunks as u64);
    assert_eq!(finished.ledger.tallies().iter().map(|t| t.lost).sum::<u64>(), 0);
    memory
}

#[test]
fn memory_does_not_grow_with_the_hours_of_a_recording() {
    let root = tempfile::tempdir().unwrap();
    let unsplit =
        WriterOptions { split_after: Duration::MAX, split_bytes: u64::MAX, ..WriterOptions::default() };
    let whole = record(&root.path().join("whole"), unsplit, 1.0);
    let an_hour_unsplit = (whole[3] - whole[0]) * 4 / 3;

    let directory = root.path().join("split");
    PEAK.store(NOW.load(Relaxed), Relaxed);
    let before = NOW.load(Relaxed);
    let split = record(&directory, WriterOptions::default(), 2.0);
    let an_hour_split = split[7].saturating_sub(split[3]);
    println!(
        "one file: {:.2} MB an hour; split: {:.3} MB an hour, {:.2} MB at most above the start",
        an_hour_unsplit as f64 / 1e6,
        an_hour_split as f64 / 1e6,
        (PEAK.load(Relaxed) - before) as f64 / 1e6
    );
    assert!(an_hour_split < 1_000_000, "{an_hour_split} bytes an hour");

    // The parts are one recording.
    let recording = Recording::open(&directory).unwrap();
    let files = recording.info().files.len();
    assert!((8..=9).contains(&files), "{files} files");
    assert_eq!(recording.warnings(), []);
    let times: Vec<u64> = recording.messages(&Selection::default()).unwrap().map(|m| m.log_time).collect();
    assert_eq!(times.len(), 2 * 9000 * 12);
    assert!(times.windows(2).all(|w| w[0] < w[1]));
    assert!(recording.ledger().unwrap().iter().all(|t| (t.recorded, t.lost) == (18_000, 0)));
}
