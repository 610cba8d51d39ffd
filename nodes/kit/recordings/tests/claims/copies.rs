//! Copies have the messages of their sources, and nothing is lost or overwritten on the way.

use crate::support::{SIMULATOR, START, Said, contract, open, options, run_in, said, sample, write_run};
use grainlab_core::{Cell, Contact, Material, Packing, Vec3};
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::to_cdr;
use grainlab_pictures::{Drawn, Picture};
use grainlab_recordings::copy::{CopyOptions, copy};
use grainlab_recordings::{
    COPY_RECORD, ChannelInfo, Compression, METADATA_RECORD, Recording, RunWriter, SeveralRuns, TopicSpec,
};
use std::path::Path;

fn sound(path: &Path) -> Recording {
    let check = open(path).check();
    assert!(check.warnings.is_empty() && check.unaccounted.is_empty(), "{check:?}");
    open(path)
}

#[test]
fn every_compression_keeps_every_message() {
    let root = tempfile::tempdir().unwrap();
    let (run, _) = run_in(&root, 30_000);
    let source = [open(&run)];
    for compression in [Compression::None, Compression::Lz4, Compression::Zstd] {
        for name in [format!("{compression:?}"), format!("{compression:?}.mcap")] {
            let to = root.path().join(name);
            let options = CopyOptions { compression, ..CopyOptions::default() };
            let copied = copy(&source, &to, &options).unwrap();
            let made = sound(&to);
            assert!(made.info().chunks > 1, "{compression:?}");
            assert_eq!(said(&made), said(&source[0]), "{compression:?}");
            assert_eq!(copied.messages, made.info().messages);
            assert_eq!(made.stored_files(), source[0].stored_files());
            assert_eq!(made.metadata(METADATA_RECORD).unwrap()["seed"], "7");
            assert!(made.metadata(COPY_RECORD).unwrap()["sources"].contains("demo-7-1"));
            assert!(made.ledger().is_none(), "the ledger counts the messages of the source");
        }
    }
}

#[test]
fn a_cut_begins_with_the_latched_messages_of_a_late_reader() {
    let root = tempfile::tempdir().unwrap();
    let (run, _) = run_in(&root, 300);
    let source = [open(&run)];
    let (start, end) = (START + 150_000_000, START + 200_000_000);
    let options = CopyOptions { start: Some(start), end: Some(end), ..CopyOptions::default() };
    let to = root.path().join("cut");
    let copied = copy(&source, &to, &options).unwrap();
    let made = said(&sound(&to));
    let inside: Vec<Said> = said(&source[0]).into_iter().filter(|m| (start..end).contains(&m.2)).collect();
    assert_eq!((copied.latched, made[1..].to_vec()), (1, inside));
    let packing = said(&source[0]).into_iter().find(|m| m.0 == "/packing").unwrap();
    assert_eq!((&made[0].0, made[0].2, made[0].3, &made[0].4), (&packing.0, start, packing.3, &packing.4));
}

#[test]
fn parts_of_a_recording_merged_are_the_recording_again() {
    let root = tempfile::tempdir().unwrap();
    let (run, _) = run_in(&root, 300);
    let source = [open(&run)];
    let is_stress = |c: &ChannelInfo| c.topic == "/stress";
    let others = |c: &ChannelInfo| c.topic != "/stress";
    let (a, b, both) = (root.path().join("a.mcap"), root.path().join("b"), root.path().join("both"));
    let options = CopyOptions::default();
    copy(&source, &a, &CopyOptions { channel: &is_stress, ..CopyOptions::default() }).unwrap();
    copy(&source, &b, &CopyOptions { channel: &others, ..CopyOptions::default() }).unwrap();
    assert_eq!(open(&a).channels().len(), 1);
    let copied = copy(&[open(&b), open(&a)], &both, &options).unwrap();
    assert_eq!(said(&sound(&both)), said(&source[0]));
    assert!(copied.notes.is_empty(), "equal stored files and records are one: {:?}", copied.notes);
    assert_eq!(sound(&both).stored_files(), source[0].stored_files());
}

#[test]
fn a_message_that_two_recordings_have_is_written_once_and_said() {
    let root = tempfile::tempdir().unwrap();
    let (run, _) = run_in(&root, 300);
    let (twice, part, with) = (root.path().join("twice"), root.path().join("part"), root.path().join("with"));
    let options = CopyOptions::default();
    let copied = copy(&[open(&run), open(&run)], &twice, &options).unwrap();
    let count = said(&open(&run)).len();
    assert_eq!(said(&sound(&twice)), said(&open(&run)));
    assert!(
        copied.notes.concat().contains(&format!("{count} messages are in more than one")),
        "{:?}",
        copied.notes
    );
    // A part of it adds nothing, and the messages of another run stay.
    let middle = CopyOptions {
        channel: &|c| !c.is_latched(),
        start: Some(START + 100_000_000),
        end: Some(START + 200_000_000),
        ..CopyOptions::default()
    };
    copy(&[open(&run)], &part, &middle).unwrap();
    copy(&[open(&run), open(&part)], &with, &options).unwrap();
    assert_eq!(said(&sound(&with)), said(&open(&run)));
}

#[test]
fn a_copy_that_is_interrupted_leaves_nothing() {
    let root = tempfile::tempdir().unwrap();
    let (run, _) = run_in(&root, 300);
    let interrupted =
        |_| Err(grainlab_console::Failure::new(grainlab_msgs::Exit::Interrupted, "interrupted"));
    for name in ["cut", "cut.mcap"] {
        let options = CopyOptions { progress: &interrupted, ..CopyOptions::default() };
        let error = copy(&[open(&run)], &root.path().join(name), &options).unwrap_err();
        assert_eq!(error.exit, grainlab_msgs::Exit::Interrupted);
    }
    assert_eq!(std::fs::read_dir(root.path()).unwrap().count(), 1, "only the run is there");
}

#[test]
fn recordings_of_two_runs_in_one_are_said() {
    let root = tempfile::tempdir().unwrap();
    let paths = ["a", "b"].map(|name| {
        let path = root.path().join(name);
        let mut run = RunWriter::create(&path, name, &[], Default::default()).unwrap();
        run.set_metadata("run", name);
        run.finish().unwrap();
        path
    });
    let sources = [open(&paths[0]), open(&paths[1])];
    let copied = copy(&sources, &root.path().join("both"), &CopyOptions::default()).unwrap();
    assert!(copied.notes.concat().contains("of several runs (a, b)"), "{:?}", copied.notes);
}

#[test]
fn files_of_one_name_and_different_content_are_all_kept() {
    let root = tempfile::tempdir().unwrap();
    let (a, b) = (root.path().join("a"), root.path().join("b"));
    for (path, text) in [(&a, "name = 1"), (&b, "name = 2")] {
        let mut run = RunWriter::create(path, "r", &[], Default::default()).unwrap();
        run.attach("scene.toml", "application/toml", text.as_bytes()).unwrap();
        run.set_metadata("seed", text);
        run.finish().unwrap();
    }
    let to = root.path().join("both");
    let copied = copy(&[open(&a), open(&b)], &to, &CopyOptions::default()).unwrap();
    let names: Vec<String> = sound(&to).stored_files().into_iter().map(|f| f.name).collect();
    assert_eq!(names, ["scene.toml", "scene.2.toml"]);
    assert_eq!(copied.notes.len(), 2, "{:?}", copied.notes);
    assert_eq!(open(&to).metadata("grainlab.2").unwrap()["seed"], "name = 2");
}

#[test]
fn a_topic_with_other_fields_is_an_error_whatever_its_hash_and_one_with_other_comments_is_not() {
    for hash in ["", "RIHS01_00"] {
        other_fields_and_comments(hash);
    }
}

fn other_fields_and_comments(hash: &str) {
    let root = tempfile::tempdir().unwrap();
    let with = |name: &str, definition: &str| {
        let spec = TopicSpec {
            name: "/a".into(),
            ros_type: "p/msg/A".into(),
            definition: definition.into(),
            schema_encoding: if definition.is_empty() { "".into() } else { "ros2msg".into() },
            type_hash: hash.into(),
            qos: String::new(),
        };
        let path = root.path().join(name);
        RunWriter::create(&path, name, &[spec], Default::default()).unwrap().finish().unwrap();
        open(&path)
    };
    let recordings = [with("a", "int8 x"), with("b", "int8 x # m")];
    let to = root.path().join("both");
    assert_eq!(copy(&recordings, &to, &CopyOptions::default()).unwrap().topics, 1);
    let recordings = [with("c", "int8 x"), with("d", "int16 x")];
    let to = root.path().join("never");
    let error = copy(&recordings, &to, &CopyOptions::default()).unwrap_err();
    assert!(error.to_string().starts_with("/a is p/msg/A"), "{error}");
    let recordings = [with("e", "int8 x"), with("f", "")];
    let error = copy(&recordings, &to, &CopyOptions::default()).unwrap_err();
    let path = recordings[1].path().display();
    let expected = format!("/a in {path}: the recording has no definition of p/msg/A: give a folder");
    assert!(error.to_string().starts_with(&expected) && error.to_string().contains("--msg-path"), "{error}");
    assert!(!to.exists());
}

#[test]
fn an_existing_output_is_never_touched() {
    let root = tempfile::tempdir().unwrap();
    let (run, bytes) = run_in(&root, 50);
    let before = std::fs::read_dir(root.path()).unwrap().count();
    for to in [run.clone(), run.join("demo-7-1_0.mcap")] {
        let error = copy(&[open(&run)], &to, &CopyOptions::default()).unwrap_err();
        assert!(error.to_string().contains("nothing is overwritten"), "{error}");
    }
    assert_eq!(std::fs::read(run.join("demo-7-1_0.mcap")).unwrap(), bytes);
    assert_eq!(std::fs::read_dir(root.path()).unwrap().count(), before, "no temporary file is left");
}

#[test]
fn a_damaged_recording_is_copied_as_far_as_it_is_readable_and_the_loss_is_a_warning() {
    let root = tempfile::tempdir().unwrap();
    let finished = write_run(&root.path().join("run"), 300);
    let mut bytes = std::fs::read(&finished.file).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0xff;
    let path = root.path().join("damaged.mcap");
    std::fs::write(&path, bytes).unwrap();
    let source = [open(&path)];
    let to = root.path().join("copy.mcap");
    copy(&source, &to, &CopyOptions::default()).unwrap();
    assert!(!source[0].warnings().is_empty());
    assert_eq!(said(&sound(&to)), said(&open(&path)));
}

#[test]
fn pictures_stand_beside_their_packings_and_a_packing_without_one_is_named() {
    let root = tempfile::tempdir().unwrap();
    let (run, _) = run_in(&root, 150);
    let other = root.path().join("other");
    let mut writer = RunWriter::create(&other, "other", &contract(), options()).unwrap();
    let packing = reference_packing();
    let body = to_cdr(&packing_message(&packing, "other", Vec::new()));
    writer.write("/packing", &sample(SIMULATOR, 1, START, &body)).unwrap();
    writer.finish().unwrap();

    let with = CopyOptions { pictures: true, ..CopyOptions::default() };
    let source = [open(&other), open(&run)];
    let to = root.path().join("pictured.mcap");
    let copied = copy(&source, &to, &with).unwrap();
    // The packing of the other run is empty, which none is.
    assert_eq!((copied.pictures, copied.is_incomplete), (2, true));
    assert!(
        copied.notes.iter().any(|n| n.contains("no picture") && n.contains("cell")),
        "{:?}",
        copied.notes
    );
    let made = sound(&to);
    let found = said(&made);
    for picture in Picture::ALL {
        let name = picture.topic().absolute_name();
        let channel = made.channel(&name).unwrap();
        assert_eq!((channel.type_hash.as_str(), channel.is_latched()), (picture.topic().info.hash, true));
        let [(_, sequence, log_time, _, payload)] =
            &found.iter().filter(|m| m.0 == name).collect::<Vec<_>>()[..]
        else {
            panic!("one {name}")
        };
        assert_eq!((*sequence, *log_time), (1, START), "those of the packing");
        assert_eq!(*payload, picture.encoded(&Drawn::new(&packing)));
    }
    let without = found.into_iter().filter(|m| !m.0.starts_with("/packing/")).collect::<Vec<_>>();
    let plain = root.path().join("plain.mcap");
    copy(&source, &plain, &CopyOptions::default()).unwrap();
    assert_eq!(without, said(&sound(&plain)), "nothing else differs");

    let again = copy(&[made], &root.path().join("again"), &with);
    assert!(again.unwrap_err().to_string().starts_with("there is a topic /packing/points already"));
    let stress = CopyOptions { channel: &|c| c.topic == "/stress", ..with };
    let none = copy(&source, &root.path().join("none"), &stress);
    assert!(none.unwrap_err().to_string().contains("of which pictures could be made"));
}

/// Two grains that touch.
fn reference_packing() -> Packing {
    let radius = 1e-4;
    let overlap = 1e-8;
    let force = Material::GLASS.normal_force(radius / 2.0, overlap);
    let contact = Contact::pressed([0, 1], [0; 3], Vec3::x(), overlap, force);
    Packing {
        step: 7,
        time: 0.25,
        contacts: vec![contact],
        friction: 0.3,
        time_step: 1e-8,
        ..Packing::at_rest(
            Cell::cube(1e-3).unwrap(),
            vec![radius; 2],
            vec![Vec3::repeat(2e-4), Vec3::new(4e-4 - overlap, 2e-4, 2e-4)],
        )
    }
}

#[test]
fn a_merged_recording_of_two_runs_is_told_from_that_of_one() {
    let root = tempfile::tempdir().unwrap();
    let run = |name: &str, scene: Option<&str>, n: u64| {
        let path = root.path().join(name);
        let mut run = RunWriter::create(&path, name, &contract(), options()).unwrap();
        scene.iter().for_each(|text| run.attach("scene.toml", "application/toml", text.as_bytes()).unwrap());
        let request = to_cdr(&grainlab_msgs::msg::Stress { sequence: 1, step: n, ..Default::default() });
        run.write("/stress", &sample(SIMULATOR, n as i64, START + n, &request)).unwrap();
        run.finish().unwrap();
        open(&path)
    };
    let merged = |name: &str, runs: [Recording; 2]| {
        let to = root.path().join(name);
        copy(&runs, &to, &CopyOptions::default()).unwrap();
        open(&to)
    };
    let one = run("a", Some("seed = 1"), 1);
    assert_eq!(SeveralRuns::of(&one), None);
    let of_two = SeveralRuns::of_scenes(&merged("ab", [one, run("b", Some("seed = 2"), 2)])).unwrap();
    assert!(of_two.to_string().contains("2 different scenes (scene.2.toml, scene.toml)"), "{of_two}");
    assert!(of_two.to_string().ends_with("which its metadata grainlab_copy names"), "a cut has all scenes");
    let without_scene = merged("cd", [run("c", None, 1), run("d", None, 2)]);
    assert_eq!(SeveralRuns::of_scenes(&without_scene), None);
    let found = SeveralRuns::of(&without_scene).unwrap().to_string();
    assert!(found.contains("two different requests of number 1"), "{found}");
}
