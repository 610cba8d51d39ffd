//! A disk that other programs fill while a recording is written.

use std::io::Write;
use std::path::Path;
use std::process::Command;

use crate::support::{SIMULATOR, START, contract, sample, stress};
use grainlab_recordings::{Recording, RunWriter, Selection, WriterOptions};

/// Names the small disk to the process that this test starts on it.
const DISK: &str = "GRAINLAB_TEST_DISK";

/// Runs this test again in a process with a small disk of its own.
fn on_a_small_disk(test: &str, work: impl FnOnce(&Path)) {
    if let Some(disk) = std::env::var_os(DISK) {
        return work(Path::new(&disk));
    }
    let folder = tempfile::tempdir().unwrap();
    let isolated = |script: &str| {
        let mut command = Command::new("unshare");
        command.args(["-m", "sh", "-ec", script]).arg(std::env::current_exe().unwrap());
        command.args([test, "--exact", "--nocapture"]).env(DISK, folder.path());
        command
    };
    let mount = format!("mount -t tmpfs -o size=24m none \"${DISK}\"");
    if !isolated(&mount).output().is_ok_and(|o| o.status.success()) {
        eprintln!("skipped: no right to mount a disk here");
        return;
    }
    let output = isolated(&format!("{mount}; exec \"$0\" \"$@\"")).output().unwrap();
    let text =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    assert!(output.status.success() && text.contains("1 passed"), "{text}");
}

/// Fills the disk to the last byte.
fn fill(disk: &Path) {
    let mut file = std::fs::File::create(disk.join("others")).unwrap();
    while file.write_all(&[1; 4096]).is_ok() {}
}

#[test]
fn a_recording_on_a_disk_that_others_fill_is_completed_and_says_why_it_ends() {
    on_a_small_disk(
        "full_disk::a_recording_on_a_disk_that_others_fill_is_completed_and_says_why_it_ends",
        |disk| {
            let default = WriterOptions { free_to_start: 0, free_to_continue: 0, ..WriterOptions::default() };
            // Where the file is continued, and where the next one is due.
            for (split_bytes, what) in
                [(default.split_bytes, "cannot write"), (1 << 20, "cannot begin the file")]
            {
                let directory = disk.join("run");
                let options = WriterOptions { split_bytes, ..default.clone() };
                let mut run = RunWriter::create(&directory, "run", &contract(), options).unwrap();
                let mut written = 0_u64;
                let mut write = || {
                    // Bytes that no chunk compresses.
                    let mut state = written;
                    let noise = std::iter::repeat_with(|| {
                        state = state
                            .wrapping_mul(6_364_136_223_846_793_005)
                            .wrapping_add(1_442_695_040_888_963_407);
                        state.to_be_bytes()[0]
                    });
                    let body: Vec<u8> = stress(written).into_iter().chain(noise.take(20_000)).collect();
                    let sent = sample(SIMULATOR, written as i64 + 1, START + written, &body);
                    run.write("/stress", &sent).inspect(|_| written += 1)
                };
                (0..20).for_each(|_| _ = write().unwrap());
                fill(disk);
                let error = (0..10_000).find_map(|_| write().err()).expect("the disk is full").to_string();
                assert!(error.contains(what) && error.contains("No space left"), "{error}");
                assert!(error.ends_with("free space and run again"), "{error}");
                run.finish().unwrap();
                let recording = Recording::open(&directory).unwrap();
                let there = recording.messages(&Selection::default()).unwrap().count() as u64;
                // A message may be in the file that could not be continued by another one.
                assert!(there == written || there == written + 1, "{there} of {written}");
                assert!(recording.warnings().is_empty() && recording.unaccounted().is_empty());
                assert!(
                    recording.ledger().is_some_and(|l| l.iter().map(|t| t.recorded).sum::<u64>() == there)
                );
                assert!(recording.ended_early().is_some_and(|why| why.contains("No space left")));
                let bag = std::fs::read_to_string(directory.join("metadata.yaml")).unwrap();
                assert!(bag.contains(&format!("message_count: {there}")), "{bag}");
                std::fs::remove_dir_all(&directory).unwrap();
                std::fs::remove_file(disk.join("others")).unwrap();
            }
        },
    );
}
