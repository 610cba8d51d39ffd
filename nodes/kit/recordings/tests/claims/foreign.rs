//! Copies keep all that other programs store beside messages, and name the faults in it.

use crate::by_hand::{HI, channel, chunk, file, message, record, schema};
use crate::support::{self, Writer, attach, checked, faults, file_with, open, post, remark, said, strings};
use grainlab_recordings::copy::{CopyOptions, copy};
use grainlab_recordings::{Recording, Selection, recover};
use mcap::WriteOptions;
use mcap::records::{MessageHeader, Record};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Writes a file with what `fill` adds.
fn write(path: &Path, fill: impl FnOnce(&mut Writer)) {
    fs::write(path, file_with(WriteOptions::new(), fill)).unwrap();
}

/// Adds a channel with this definition of its type and metadata, and a message.
fn say(writer: &mut Writer, ros_type: &str, text: &str, publisher: &str, payload: &[u8]) {
    let schema = writer.add_schema(ros_type, "ros2msg", text.as_bytes()).unwrap();
    let metadata = BTreeMap::from([("publisher".to_owned(), publisher.to_owned())]);
    let channel_id = writer.add_channel(schema, "/t", "cdr", &metadata).unwrap();
    post(writer, channel_id, 5, payload);
}

fn string(writer: &mut Writer, publisher: &str, payload: &[u8]) {
    say(writer, "std_msgs/msg/String", "string data\n", publisher, payload);
}

/// The copy of a recording, and what was said of it.
fn copied(from: &Path, to: &Path) -> (Recording, String) {
    let done = copy(&[open(from)], to, &CopyOptions::default()).unwrap();
    (open(to), done.notes.join("\n"))
}

fn metadata(directory: &Path, more: &str) {
    let text = format!("rosbag2_bagfile_information:\n  relative_file_paths: [r_0.mcap]\n{more}\n");
    fs::write(directory.join("metadata.yaml"), text).unwrap();
}

/// The value `vin` of each metadata record `vehicle`, in order.
fn vehicles(path: &Path) -> Vec<String> {
    let bytes = fs::read(path).unwrap();
    let records = mcap::read::LinearReader::new(&bytes).unwrap().map(Result::unwrap);
    let vin = |record| match record {
        Record::Metadata(m) if m.name == "vehicle" => Some(m.metadata["vin"].clone()),
        _ => None,
    };
    records.filter_map(vin).collect()
}

#[test]
fn copies_keep_all_metadata_of_a_name_times_of_stored_files_and_the_channel_of_each_publisher() {
    let root = tempfile::tempdir().unwrap();
    let source = root.path().join("a.mcap");
    write(&source, |w| {
        string(w, "first", HI);
        string(w, "second", HI);
        ["123", "456"].iter().for_each(|vin| remark(w, "vehicle", "vin", vin));
        for (time, data) in [(2, b"x"), (3, b"y"), (4, b"y")] {
            attach(w, "calibration", [time, 1], data);
        }
    });
    let (made, notes) = copied(&source, &root.path().join("b.mcap"));
    // MCAP allows equal names: versions of a file have different times.
    assert_eq!(
        (vehicles(&root.path().join("b.mcap")), notes.as_str()),
        (vec!["123".into(), "456".into()], "")
    );
    let files = made.stored_files();
    let files: Vec<_> = files.iter().map(|f| (f.name.as_str(), f.time, f.created, &f.bytes[..])).collect();
    assert_eq!(
        files,
        [("calibration", 2, 1, &b"x"[..]), ("calibration", 3, 1, b"y"), ("calibration", 4, 1, b"y")]
    );
    let messages = made.messages(&Selection::default()).unwrap();
    let publishers: Vec<_> = messages.map(|m| m.channel.metadata["publisher"].clone()).collect();
    assert_eq!(publishers, ["first", "second"]);
}

/// Only the program that wrote private records knows what they refer to.
#[test]
fn a_copy_without_the_private_records_of_its_source_says_so() {
    let root = tempfile::tempdir().unwrap();
    let place = mcap::write::PrivateRecordOptions::IncludeInChunks;
    for (n, (in_chunk, with_messages)) in [(true, true), (true, false), (false, true)].into_iter().enumerate()
    {
        let (source, to) = (root.path().join(format!("{n}.mcap")), root.path().join(format!("{n}")));
        write(&source, |w| {
            string(w, "", HI);
            if !with_messages {
                w.flush().unwrap();
            }
            let options = if in_chunk { place.into() } else { Default::default() };
            w.write_private_record(0x81, b"private", options).unwrap();
        });
        let left_out = |to: &Path| {
            let recording = [open(&source)];
            let done = copy(&recording, to, &CopyOptions::default()).unwrap();
            assert_eq!((recording[0].warnings(), recording[0].check().warnings), (vec![], vec![]));
            (done.is_incomplete, done.notes)
        };
        let of_type = "records of type 0x81, which MCAP does not define (yet), are left out".to_owned();
        assert_eq!(left_out(&to), (true, vec![of_type.clone()]), "{n}");
        // A recovery writes the records in their order, and keeps them.
        let whole = fs::read(&source).unwrap();
        fs::write(&source, &whole[..whole.len() - 8]).unwrap();
        recover(&source).unwrap();
        assert_eq!(left_out(&root.path().join(format!("{n}r"))), (true, vec![of_type]), "{n}");
    }
}

/// "Record opcodes in the range 0x01-0x7F are reserved for future MCAP format usage."
#[test]
fn a_copy_and_a_recovery_without_the_records_of_a_later_version_say_so() {
    let root = tempfile::tempdir().unwrap();
    let (start, new) =
        ([schema(1, "std_msgs/msg/String"), channel(1, 1, "/t"), message(1, 5)], record(0x42, b"new"));
    let inside = chunk([5, 5], &[start.concat(), new.clone()]);
    for (n, bytes) in [file(&[start.concat(), new]), file(&[inside])].into_iter().enumerate() {
        let source = root.path().join(format!("{n}.mcap"));
        fs::write(&source, &bytes).unwrap();
        let check = open(&source).check();
        assert_eq!((check.warnings, check.unknown_records), (vec![], [0x42].into()));
        let to = root.path().join(format!("{n}"));
        let done = copy(&[open(&source)], &to, &CopyOptions::default()).unwrap();
        assert!(done.is_incomplete && done.notes.concat().contains("0x42"), "{:?}", done.notes);
        let recovery = recover(&source).unwrap();
        let left_out = recovery.unreadable().map(ToString::to_string).collect::<String>();
        assert!(left_out.contains("a record of type 0x42"), "{left_out}");
    }
}

#[test]
fn a_copy_and_a_recovery_keep_definitions_that_no_channel_uses() {
    let root = tempfile::tempdir().unwrap();
    let names = |path: &Path| {
        let bytes = fs::read(path).unwrap();
        let records = mcap::read::ChunkFlattener::new(&bytes).unwrap().map(Result::unwrap);
        let schemas = records.filter_map(|record| match record {
            Record::Schema { header, .. } => Some(header.name),
            _ => None,
        });
        schemas.collect::<std::collections::BTreeSet<_>>()
    };
    for choice in 0..8 {
        let has = |bit: u32| choice >> bit & 1 == 1;
        let (source, to) =
            (root.path().join(format!("{choice}.mcap")), root.path().join(format!("{choice}c.mcap")));
        let options = WriteOptions::new().repeat_schemas(has(0)).use_chunks(has(1));
        let whole = file_with(options, |w| {
            w.add_schema("my/msg/Unused", "ros2msg", b"uint8 x\n").unwrap();
            if has(2) {
                w.flush().unwrap();
            }
            let channel = w.add_channel(0, "/t", "cdr", &BTreeMap::new()).unwrap();
            post(w, channel, 5, HI);
        });
        fs::write(&source, &whole).unwrap();
        let (made, notes) = copied(&source, &to);
        assert_eq!((made.check().warnings, notes.as_str()), (vec![], ""), "{choice}");
        assert!(names(&to).contains("my/msg/Unused"), "{choice}");
        fs::write(&source, &whole[..whole.len() - 8]).unwrap();
        recover(&source).unwrap();
        assert!(names(&source).contains("my/msg/Unused"), "{choice}");
    }
}

#[test]
fn a_topic_with_two_types_has_a_row_for_each() {
    let root = tempfile::tempdir().unwrap();
    let source = root.path().join("a.mcap");
    write(&source, |w| {
        string(w, "", HI);
        say(w, "my/msg/Flag", "uint8 x\n", "", b"\0\x01\0\0\x01");
    });
    let rows = open(&source).info().topics;
    let rows: Vec<_> = rows.iter().map(|t| (t.name.as_str(), t.ros_type.as_str(), t.messages)).collect();
    assert_eq!(rows, [("/t", "my/msg/Flag", 1), ("/t", "std_msgs/msg/String", 1)]);
}

#[test]
fn messages_that_are_compressed_one_by_one_are_read_and_copied_as_what_they_are() {
    let root = tempfile::tempdir().unwrap();
    let source = root.path().join("r");
    fs::create_dir(&source).unwrap();
    let compression = |format: &str| format!("  compression_format: {format}\n  compression_mode: MESSAGE");
    metadata(&source, &compression("zstd"));
    write(&source.join("r_0.mcap"), |w| string(w, "", &zstd::bulk::compress(HI, 1).unwrap()));
    let payload = |recording: &Recording| said(recording).pop().map(|message| message.4);
    assert_eq!(payload(&open(&source)).unwrap(), HI);
    assert_eq!(open(&source).info().compression[0], "zstd of each message");
    assert_eq!(payload(&open(&source.join("r_0.mcap"))).unwrap(), HI);
    let (made, _) = copied(&source, &root.path().join("made"));
    assert_eq!(payload(&made).unwrap(), HI);
    fs::write(source.join("r_0.mcap"), &fs::read(source.join("r_0.mcap")).unwrap()[..400]).unwrap();
    recover(&source).unwrap();
    assert_eq!(payload(&open(&source)).unwrap(), HI, "the new metadata.yaml has the compression");
    write(&source.join("r_0.mcap"), |w| string(w, "", HI));
    let broken = open(&source);
    assert!(payload(&broken).is_none() && broken.warnings()[0].detail.contains("does not decompress"));
    metadata(&source, &compression("lz4"));
    assert!(Recording::open(&source).unwrap_err().to_string().contains("ros2 bag convert"));
}

#[test]
fn copies_and_recoveries_keep_the_custom_data_and_the_distribution_of_ros() {
    let root = tempfile::tempdir().unwrap();
    let source = root.path().join("r");
    fs::create_dir(&source).unwrap();
    metadata(&source, "  custom_data: {vin: '123'}\n  ros_distro: rolling");
    let file = source.join("r_0.mcap");
    write(&file, |w| string(w, "", HI));
    let kept = |directory: &Path| {
        let text = fs::read_to_string(directory.join("metadata.yaml")).unwrap();
        text.contains("custom_data: {\"vin\":\"123\"}") && text.contains("ros_distro: \"rolling\"")
    };
    assert!(copied(&source, &root.path().join("made")).1.is_empty() && kept(&root.path().join("made")));
    assert!(copied(&source, &root.path().join("made.mcap")).1.contains("custom_data"));
    let old = fs::read(source.join("metadata.yaml")).unwrap();
    fs::write(&file, &fs::read(&file).unwrap()[..fs::metadata(&file).unwrap().len() as usize - 8]).unwrap();
    assert!(recover(&source).unwrap().metadata_written && kept(&source));
    assert_eq!(fs::read(source.join("metadata.yaml.orig")).unwrap(), old);
}

#[test]
fn a_check_names_definitions_and_metadata_that_are_wrong_and_counts_checksums() {
    let root = tempfile::tempdir().unwrap();
    let source = root.path().join("r");
    fs::create_dir(&source).unwrap();
    write(&source.join("r_0.mcap"), |w| {
        string(w, "", HI);
        say(w, "my/msg/Bad", "this is no definition !!\n", "", HI);
    });
    for (text, expected) in
        [("  message_count: 999", "it states 999 messages"), ("  : [", "it cannot be read")]
    {
        metadata(&source, text);
        let check = open(&source).check();
        let found = checked(&open(&source));
        let both = [expected, "definition of my/msg/Bad cannot be parsed"];
        assert!(both.iter().all(|words| found.contains(words)), "{found}");
        assert_eq!((check.ros_definitions, check.all_definitions), (1, 2));
        assert!(check.checksums > 0);
    }
    assert_eq!(open(&root.path().join("r/r_0.mcap")).check().warnings.len(), 1);
}

/// Times that are rounded, the duration of rosbag2 where messages came out of order, and topics without messages are no faults.
#[test]
fn a_check_names_each_statement_of_the_metadata_that_the_files_contradict() {
    let root = tempfile::tempdir().unwrap();
    write(&root.path().join("r_0.mcap"), |w| {
        let channel = strings(w, "/t");
        [2, 5, 1].iter().for_each(|s| post(w, channel, s * 1_000_000_000, HI));
    });
    let topic = |name: &str, kind: &str, n: u64| {
        format!(
            "    - topic_metadata: {{name: {name}, type: {kind}, serialization_format: cdr, type_description_hash: RIHS01_7}}\n      message_count: {n}\n"
        )
    };
    let whole = format!(
        "  storage_identifier: mcap\n  message_count: 3\n  compression_mode: none\n  compression_format: ''\n  starting_time:\n    \
         nanoseconds_since_epoch: 1000000100\n  duration:\n    nanoseconds: 3000000000\n  topics_with_message_count:\n{}{}  files:\n    \
         - {{path: r_0.mcap, message_count: 3}}\n",
        topic("/t", "std_msgs/msg/String", 3),
        topic("/silent", "std_msgs/msg/String", 0)
    );
    let faults = |text: &str| {
        metadata(root.path(), text);
        open(root.path()).check().warnings.iter().map(|w| w.detail.clone()).collect::<Vec<_>>()
    };
    assert_eq!(faults(&whole), [""; 0]);
    copied(root.path(), &root.path().join("copy"));
    let text = fs::read_to_string(root.path().join("copy/metadata.yaml")).unwrap();
    assert!(text.contains("type_description_hash: \"RIHS01_7\""), "{text}");
    for (from, to, expected) in [
        ("identifier: mcap", "identifier: sqlite3", "storage_identifier: it states \"sqlite3\""),
        ("mode: none", "mode: FILE", "compression_mode: it states \"FILE\""),
        ("format: ''", "format: lz4", "compression_format: it states \"lz4\""),
        ("epoch: 1000000100", "epoch: 7", "starting_time: it states 7 ns"),
        ("seconds: 3000000000", "seconds: 9000000000", "duration: it states 9000000000 ns"),
        ("format: cdr", "format: json", "/t: it states the serialization_format json"),
        ("name: /t", "name: /other", "/t: it does not list it"),
        ("count: 0", "count: 4", "/silent: it states 4 messages, the files hold 0"),
        (
            "std_msgs/msg/String",
            "a/msg/B",
            "/t: it states the type a/msg/B, the files have std_msgs/msg/String",
        ),
        (
            "r_0.mcap, message_count: 3",
            "r_0.mcap, message_count: 2",
            "files: it states 2 messages in r_0.mcap",
        ),
        ("path: r_0.mcap", "path: r_7.mcap", "files: relative_file_paths does not name r_7.mcap"),
    ] {
        let found = faults(&whole.replacen(from, to, 1));
        assert!(found.iter().any(|f| f.starts_with(expected)), "{expected}: {found:?}");
    }
    write(&root.path().join("r_0.mcap"), |w| string(w, "", b"\0\x01\0\0\x09\0\0\0hi\0"));
    assert!(faults("")[0].starts_with("/t: its message of 5 ns does not decode"));
}

/// Recorders number messages differently, and a default of a field is in no message.
#[test]
fn a_message_that_two_programs_recorded_is_merged_to_one_though_number_and_default_differ() {
    let root = tempfile::tempdir().unwrap();
    let paths = [(1, "string data\n"), (0, "string data \"none\"\n")].map(|(sequence, text)| {
        let path = root.path().join(format!("{sequence}.mcap"));
        write(&path, |w| {
            let channel_id = support::declare(w, "/t", "my/msg/A", text);
            let header = MessageHeader { channel_id, sequence, log_time: 5, publish_time: 4 };
            w.write_to_known_channel(&header, HI).unwrap();
        });
        open(&path)
    });
    let done = copy(&paths, &root.path().join("both"), &CopyOptions::default()).unwrap();
    assert_eq!((done.messages, done.topics), (1, 1), "{:?}", done.notes);
}

#[test]
fn files_of_other_formats_are_refused_with_their_name_and_a_remedy() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("a.mcap");
    for (bytes, name) in [(&b"\x28\xb5\x2f\xfd1234"[..], "Zstandard"), (b"SQLite format 3\0", "SQLite")] {
        fs::write(&path, bytes).unwrap();
        let error = Recording::open(&path).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("ros2 bag convert"), "{error}");
    }
}

/// A file is lost where it has no byte, is not where `metadata.yaml` says, or where fewer messages are found than that states.
#[test]
fn a_directory_that_lacks_messages_of_its_metadata_is_damaged_and_parts_in_folders_are_read() {
    let root = tempfile::tempdir().unwrap();
    let directory = root.path();
    fs::create_dir(directory.join("data")).unwrap();
    for name in ["r_0.mcap", "data/r_1.mcap"] {
        write(&directory.join(name), |w| string(w, "one", HI));
    }
    fs::write(directory.join("empty.mcap"), b"").unwrap();
    let stated = |files: &str, messages: u64| {
        let information = format!("relative_file_paths: [{files}]\n  message_count: {messages}");
        let text = format!("rosbag2_bagfile_information:\n  {information}\n");
        fs::write(directory.join("metadata.yaml"), text).unwrap();
        faults(&open(directory))
    };
    assert_eq!(stated("r_0.mcap, data/r_1.mcap", 2), "");
    for (files, messages, fault) in [
        ("r_0.mcap, data/r_1.mcap", 3, "states 3 messages, the files hold 2"),
        ("r_0.mcap, data/r_1.mcap, empty.mcap", 3, "it is empty"),
        ("r_0.mcap, ../r_1.mcap", 2, "outside of its directory"),
        ("r_0.mcap, data/r_9.mcap", 2, "data/r_9.mcap is missing"),
    ] {
        let found = stated(files, messages);
        assert!(found.contains(fault), "{fault}: {found}");
    }
    let missing = recover(directory).unwrap().missing;
    assert_eq!(missing.len(), 1, "a recovery says it, too: {missing:?}");
}

#[test]
fn a_metadata_file_that_cannot_be_read_is_named_by_every_reader() {
    let root = tempfile::tempdir().unwrap();
    write(&root.path().join("r_0.mcap"), |w| string(w, "", HI));
    let path = root.path().join("metadata.yaml");
    let named = |fault: &str| {
        let faults = [open(root.path()).warnings(), open(root.path()).check().warnings];
        for faults in &faults {
            let [found] = &faults[..] else { panic!("{fault}: {faults:?}") };
            assert!(found.path == path && found.detail.contains("it cannot be read"), "{found}");
            assert!(found.detail.contains(fault), "{fault}: {found}");
        }
        assert_eq!(said(&open(root.path())).len(), 1);
    };
    for (content, fault) in
        [(&b"\xff\xfe"[..], "not UTF-8"), (b"a: [", ""), (b"a: 1", "rosbag2_bagfile"), (b"", "")]
    {
        fs::write(&path, content).unwrap();
        named(fault);
    }
    fs::remove_file(&path).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
    named("it is a pipe");
    // A file is a recording without it.
    assert_eq!(open(&root.path().join("r_0.mcap")).warnings(), []);
}

#[test]
fn a_file_that_a_directory_has_twice_is_read_once_and_named() {
    let root = tempfile::tempdir().unwrap();
    let directory = root.path();
    write(&directory.join("r_0.mcap"), |w| string(w, "", HI));
    std::os::unix::fs::symlink("r_0.mcap", directory.join("s_0.mcap")).unwrap();
    let stated = |files: &str| {
        let text = format!("rosbag2_bagfile_information:\n  relative_file_paths: [{files}]\n");
        fs::write(directory.join("metadata.yaml"), text).unwrap();
    };
    let found = || {
        let recording = open(directory);
        (said(&recording).len(), faults(&recording))
    };
    stated("r_0.mcap, r_0.mcap");
    let (count, faults) = found();
    assert!(count == 1 && faults.contains("metadata.yaml names it twice"), "{count} {faults}");
    stated("r_0.mcap, s_0.mcap");
    let (count, faults) = found();
    assert!(count == 1 && faults.contains("it is the same file as"), "{count} {faults}");
    fs::remove_file(directory.join("metadata.yaml")).unwrap();
    assert_eq!(found().0, 1);
}
