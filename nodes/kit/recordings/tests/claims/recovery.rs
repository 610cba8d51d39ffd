//! A truncated recording is completed without loss of readable messages.

use std::fs;
use std::path::Path;

use crate::support::{self, SIMULATOR, START, Said, contract, open, options, run_in, sample, stress};
use grainlab_recordings::{METADATA_RECORD, Recording, RunWriter, WarningKind, recover};

fn said(path: &Path) -> Vec<Said> {
    support::said(&open(path))
}

/// Position of the last attachment, after all messages and before the ledger and the index.
fn before_the_end(bytes: &[u8]) -> usize {
    bytes.windows(8).position(|w| w == b"late.txt").unwrap()
}

/// A run directory whose recorder was killed: the file ends at `cut`, without metadata.yaml.
fn killed(root: &Path, bytes: &[u8], cut: usize) -> std::path::PathBuf {
    let directory = root.join(format!("cut-{cut}"));
    fs::create_dir(&directory).unwrap();
    fs::write(directory.join(format!("cut-{cut}_0.mcap")), &bytes[..cut]).unwrap();
    directory
}

#[test]
fn a_file_cut_anywhere_keeps_every_message_that_could_be_read() {
    let root = tempfile::tempdir().unwrap();
    let (_, bytes) = run_in(&root, 400);
    for cut in (20..bytes.len()).step_by(bytes.len() / 60).chain([bytes.len() - 1]) {
        let directory = killed(root.path(), &bytes, cut);
        let (before, files) = (said(&directory), open(&directory).stored_files());
        let channels = open(&directory).channels();
        let done = recover(&directory).unwrap();
        assert!(done.changed() && done.files[0].messages == before.len() as u64, "cut at {cut}: {done:?}");
        assert_eq!(said(&directory), before, "cut at {cut}");
        let recording = open(&directory);
        assert_eq!(recording.check().warnings, [], "cut at {cut}");
        assert_eq!(recording.stored_files(), files, "cut at {cut}");
        assert_eq!(recording.channels(), channels, "cut at {cut}");
        assert!(recording.info().complete && directory.join("metadata.yaml").exists());
        assert_eq!(recording.metadata(METADATA_RECORD).unwrap()["recovered"], "true");
        let original = done.files[0].original.clone().unwrap();
        assert_eq!(fs::read(original).unwrap(), &bytes[..cut]);
        // The second call changes no byte.
        let file = directory.join(format!("cut-{cut}_0.mcap"));
        let recovered = fs::read(&file).unwrap();
        let again = recover(&directory).unwrap();
        assert!(!again.changed() && again.files[0].original.is_none());
        assert_eq!(fs::read(&file).unwrap(), recovered);
    }
}

#[test]
fn a_damaged_chunk_of_a_cut_file_is_left_out_and_named() {
    let root = tempfile::tempdir().unwrap();
    let (_, mut bytes) = run_in(&root, 1000);
    let cut = bytes.len() * 3 / 4;
    let chunks = mcap::Summary::read(&bytes).unwrap().unwrap().chunk_indexes;
    let chunk = chunks.iter().rfind(|c| c.chunk_start_offset + c.chunk_length < cut as u64 * 9 / 10).unwrap();
    bytes[(chunk.chunk_start_offset + chunk.chunk_length * 2 / 3) as usize] ^= 8;
    let directory = killed(root.path(), &bytes, cut);
    let before = said(&directory);
    let done = recover(&directory).unwrap();
    assert!(done.unreadable().any(|w| w.kind == WarningKind::DamagedChunk), "{done:?}");
    assert!(before.len() > 300 && said(&directory) == before);
    let metadata = open(&directory).metadata(METADATA_RECORD).unwrap();
    assert!(metadata["recovered_without"].contains("chunk"), "{metadata:?}");
    assert!(!recover(&directory).unwrap().changed());
    // The recorder wrote its ledger, which shows the damage.
    let check = open(&directory).check();
    let left_out = check.recovered.values().flatten();
    assert!(left_out.map(|w| w.kind).any(|kind| kind == WarningKind::DamagedChunk), "{check:?}");
    let faults = check.warnings;
    assert!(!faults.is_empty() && faults.iter().all(|w| w.detail.contains("ledger")), "{faults:?}");
}

#[test]
fn a_whole_recording_is_left_alone_and_a_damaged_one_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let (directory, mut bytes) = run_in(&root, 300);
    assert!(!recover(&directory).unwrap().changed());
    let file = directory.join("demo-7-1_0.mcap");
    assert_eq!(fs::read(&file).unwrap(), bytes);
    bytes[3000] ^= 1;
    fs::write(&file, &bytes).unwrap();
    let error = recover(&directory).unwrap_err();
    assert!(error.to_string().contains("is complete but damaged"), "{error}");
    assert_eq!(fs::read(&file).unwrap(), bytes);
}

#[test]
fn a_recording_under_way_is_refused_and_recovered_when_its_recorder_is_gone() {
    let root = tempfile::tempdir().unwrap();
    let directory = root.path().join("r");
    let mut run = RunWriter::create(&directory, "r", &contract(), options()).unwrap();
    run.write("/stress", &sample(SIMULATOR, 1, START, &stress(1))).unwrap();
    let error = recover(&directory).unwrap_err();
    assert!(error.to_string().contains("is being recorded"), "{error}");
    run.finish().unwrap();
    assert!(!recover(&directory).unwrap().changed());
}

#[test]
fn a_resumed_run_goes_on_in_the_next_file_behind_the_last_log_time() {
    let root = tempfile::tempdir().unwrap();
    let (directory, bytes) = run_in(&root, 200);
    let first = said(&directory);
    // The first recorder was killed after 200 messages, before its end.
    fs::remove_file(directory.join("metadata.yaml")).unwrap();
    fs::write(directory.join("demo-7-1_0.mcap"), &bytes[..before_the_end(&bytes)]).unwrap();
    recover(&directory).unwrap();
    let kept = said(&directory);
    assert_eq!(kept, first[..kept.len()]);
    for session in 1..3i64 {
        let mut run = RunWriter::append(&directory, "demo-7-1", &contract(), options()).unwrap();
        assert!(run.file().ends_with(format!("demo-7-1_{session}.mcap")));
        let held = RunWriter::append(&directory, "demo-7-1", &contract(), options()).err().unwrap();
        assert!(held.to_string().contains("is being recorded"), "{held}");
        for n in 1..=50 {
            // The clock was set back: log times still increase.
            let time = START + 1_000_000 * n as u64;
            run.write("/stress", &sample(SIMULATOR, 1000 * session + n, time, &stress(n as u64))).unwrap();
        }
        assert_eq!(run.finish().unwrap().messages, 50);
    }
    let recording = open(&directory);
    assert_eq!(recording.check().warnings, []);
    assert_eq!(recording.paths().len(), 3);
    let all = said(&directory);
    assert_eq!(all.len(), kept.len() + 100);
    assert!(all.windows(2).all(|w| w[0].2 < w[1].2));
    for of_session in all[kept.len()..].chunks(50) {
        let intervals = of_session.windows(2).map(|w| w[1].2 - w[0].2);
        assert!(intervals.eq([1_000_000; 49]), "the intervals between messages are kept");
    }
    let text = fs::read_to_string(directory.join("metadata.yaml")).unwrap();
    let yaml: serde_json::Value = serde_saphyr::from_str(&text).unwrap();
    let bag = &yaml["rosbag2_bagfile_information"];
    assert_eq!(bag["message_count"].as_u64(), Some(all.len() as u64));
    let counts: Vec<u64> =
        bag["files"].as_array().unwrap().iter().map(|f| f["message_count"].as_u64().unwrap()).collect();
    assert_eq!(counts, [kept.len() as u64, 50, 50]);
    // Both ledgers are combined; the first recorder, which was killed, has none.
    let ledger = recording.ledger().unwrap();
    assert_eq!(ledger.iter().find(|t| t.name == "/stress").unwrap().recorded, 100);
    assert_eq!(recording.unaccounted(), [directory.join("demo-7-1_0.mcap")]);
}

#[test]
fn a_part_that_metadata_yaml_does_not_know_is_read_and_named() {
    let root = tempfile::tempdir().unwrap();
    let (directory, _) = run_in(&root, 30);
    let whole = said(&directory).len();
    let mut run = RunWriter::append(&directory, "demo-7-1", &contract(), options()).unwrap();
    run.write("/stress", &sample(SIMULATOR, 31, START, &stress(31))).unwrap();
    let yaml = fs::read(directory.join("metadata.yaml")).unwrap();
    run.finish().unwrap();
    fs::write(directory.join("metadata.yaml"), yaml).unwrap();
    let recording = open(&directory);
    let kinds: Vec<WarningKind> = recording.warnings().iter().map(|w| w.kind).collect();
    assert_eq!((said(&directory).len(), kinds), (whole + 1, vec![WarningKind::Unlisted]));
    assert!(recover(&directory).unwrap().metadata_written);
    assert_eq!(open(&directory).warnings(), []);
}

/// A power cut or a full disk leaves a file without a byte.
#[test]
fn an_empty_file_that_no_recorder_writes_is_replaced_and_no_other_is() {
    let root = tempfile::tempdir().unwrap();
    let (directory, file) = (root.path().join("r"), root.path().join("r/r_0.mcap"));
    fs::create_dir(&directory).unwrap();
    let created = || RunWriter::create(&directory, "r", &contract(), options());
    let refused = || created().err().unwrap().to_string();
    fs::write(&file, "").unwrap();
    let held = fs::File::open(&file).unwrap();
    held.lock().unwrap();
    assert!(refused().contains("exists: choose another directory"), "a recorder that has just begun");
    drop(held);
    created().unwrap().finish().unwrap();
    assert!(refused().contains("exists: choose another directory"));
    fs::remove_file(directory.join("metadata.yaml")).unwrap();
    fs::remove_file(&file).unwrap();
    std::os::unix::fs::symlink("elsewhere", &file).unwrap();
    assert!(refused().contains("exists: choose another directory") && !directory.join("elsewhere").exists());
}

#[test]
fn a_new_recording_is_not_begun_in_a_directory_with_a_recording_or_the_metadata_of_another() {
    let root = tempfile::tempdir().unwrap();
    let (directory, bytes) = run_in(&root, 20);
    let yaml = fs::read(directory.join("metadata.yaml")).unwrap();
    for removed in ["", "metadata.yaml", "demo-7-1_0.mcap"] {
        let _ = fs::remove_file(directory.join(removed));
        let refused = RunWriter::create(&directory, "other", &contract(), options()).err().unwrap();
        assert_eq!(refused.exit, grainlab_msgs::Exit::Usage, "{removed}");
        assert!(refused.to_string().contains("a recording is never overwritten"), "{refused}");
        assert!(!directory.join("other_0.mcap").exists());
        fs::write(directory.join("metadata.yaml"), &yaml).unwrap();
    }
    fs::write(directory.join("demo-7-1_0.mcap"), bytes).unwrap();
    assert_eq!(open(&directory).check().warnings, []);
}

#[test]
fn a_run_whose_files_are_lost_begins_again_in_its_directory() {
    let root = tempfile::tempdir().unwrap();
    let (directory, _) = run_in(&root, 20);
    fs::write(directory.join("demo-7-1_0.mcap"), "").unwrap();
    let run = RunWriter::append(&directory, "demo-7-1", &contract(), options()).unwrap();
    assert!(run.file().ends_with("demo-7-1_0.mcap"));
    run.finish().unwrap();
    assert_eq!(open(&directory).warnings(), []);
}

/// A recorder that is killed when it has just begun its file leaves a file without a byte.
#[test]
fn an_empty_part_between_others_that_metadata_yaml_does_not_name_is_no_loss() {
    let root = tempfile::tempdir().unwrap();
    let (directory, _) = run_in(&root, 20);
    fs::write(directory.join("demo-7-1_1.mcap"), "").unwrap();
    let run = RunWriter::append(&directory, "demo-7-1", &contract(), options()).unwrap();
    assert!(run.file().ends_with("demo-7-1_2.mcap"));
    run.finish().unwrap();
    assert_eq!(open(&directory).check().warnings, []);
    let yaml = fs::read_to_string(directory.join("metadata.yaml")).unwrap();
    let line = yaml.lines().find(|line| line.contains("demo-7-1_2.mcap")).unwrap();
    let named = yaml.replacen(line, &format!("{}\n{line}", line.replace("_2.mcap", "_1.mcap")), 1);
    fs::write(directory.join("metadata.yaml"), named).unwrap();
    let warnings = open(&directory).warnings();
    assert!(warnings.iter().any(|w| w.detail.contains("what was recorded in it is lost")), "{warnings:?}");
}

/// Readers of rosbag2 see the files that `metadata.yaml` names.
#[test]
fn a_file_that_metadata_yaml_does_not_name_is_reported_whatever_its_name() {
    let root = tempfile::tempdir().unwrap();
    let (directory, bytes) = run_in(&root, 20);
    let whole = said(&directory).len();
    let other = directory.join("camera.mcap");
    fs::write(&other, "").unwrap();
    fs::hard_link(directory.join("demo-7-1_0.mcap"), directory.join("link.mcap")).unwrap();
    assert_eq!(open(&directory).warnings(), [], "nothing of their own is in them");
    for name in ["camera.mcap", "other_0.mcap", "other_7.mcap"] {
        fs::write(directory.join(name), &bytes).unwrap();
        let warnings = open(&directory).warnings();
        let kinds: Vec<_> = warnings.iter().map(|w| (w.kind, w.path.clone())).collect();
        assert_eq!(kinds, [(WarningKind::Unread, directory.join(name))]);
        assert!(warnings[0].to_string().contains("is not read: metadata.yaml does not name it"));
        assert_eq!(said(&directory).len(), whole);
        fs::remove_file(directory.join(name)).unwrap();
    }
}

#[test]
fn a_pipe_among_the_files_of_a_run_stops_no_reader_and_no_recorder() {
    let root = tempfile::tempdir().unwrap();
    let pipe = root.path().join("r_3.mcap");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for error in [Recording::open(root.path()).unwrap_err(), recover(root.path()).unwrap_err()] {
        assert!(error.to_string().contains("r_3.mcap: it is a pipe"), "{error}");
    }
    let run = RunWriter::append(root.path(), "r", &contract(), options()).unwrap();
    assert!(run.file().ends_with("r_4.mcap"));
    // It has no byte, and is no part that a recorder has just begun.
    let (directory, _) = run_in(&root, 30);
    let next = directory.join("demo-7-1_1.mcap");
    fs::write(&next, "").unwrap();
    assert_eq!(open(&directory).warnings(), []);
    fs::rename(&pipe, &next).unwrap();
    assert!(Recording::open(&directory).unwrap_err().to_string().contains("demo-7-1_1.mcap: it is a pipe"));
}
