//! Recordings whose definition of a type is not that of this program.

use std::path::{Path, PathBuf};

use grainlab_any_message::{Comparison, Schema};
use grainlab_core::{Cell, Mat3, Material, Packing};
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::{Message as _, Topic, msg, to_cdr, topics};
use grainlab_recordings::import::{ImportOptions, load};
use grainlab_recordings::{Recording, RunWriter, Selection, TopicSpec};

use crate::support::{SIMULATOR, START, options, sample};

fn two_grains() -> Packing {
    let (ids, radii) = (vec![1, 2], vec![0.11; 2]);
    let positions = vec![[0.1, 0.1, 0.1].into(), [0.1, 0.1, 0.3].into()];
    Packing {
        step: 7,
        time: 0.5,
        ids,
        material: Material { shear_modulus: 29e9, poisson_ratio: 0.2, density: 2500.0 },
        friction: 0.3,
        time_step: 1e-6,
        ..Packing::at_rest(Cell::new(Mat3::identity()).unwrap(), radii, positions)
    }
    .validated()
    .unwrap()
}

fn message_of(packing: &Packing) -> msg::Packing {
    packing_message(packing, "two", Vec::new())
}

/// A recording with one packing, as a program with this definition of its type writes it.
fn written(root: &Path, definition: &str, payload: &[u8]) -> PathBuf {
    let topic = Topic::by_name(topics::PACKING.name).unwrap();
    let spec = TopicSpec { definition: definition.to_owned(), ..TopicSpec::of_contract(topic, "/packing") };
    let mut run = RunWriter::create(&root.join("run"), "run", &[spec], options()).unwrap();
    run.write("/packing", &sample(SIMULATOR, 1, START, payload)).unwrap();
    run.finish().unwrap().file
}

const MOVED: [&str; 2] = ["shear_modulus", "poisson_ratio"];

/// The definition of this program with the lines of two fields exchanged.
fn exchanged([a, b]: [&str; 2]) -> String {
    let own = msg::Packing::DEFINITION;
    let line = |name: &str| {
        let is_field = |l: &&str| l.split('#').next().unwrap().split_whitespace().nth(1) == Some(name);
        own.lines().find(is_field).unwrap().to_owned()
    };
    let (a, b) = (line(a), line(b));
    own.replace(&a, "\u{0}").replace(&b, &a).replace('\u{0}', &b)
}

#[test]
fn fields_in_another_order_are_read_by_their_names_with_a_warning() {
    let root = tempfile::tempdir().unwrap();
    let packing = two_grains();
    let definition = exchanged(MOVED);
    let parsed = |text: &str| Schema::parse(msg::Packing::TYPE, text).unwrap();
    let Comparison::Mapped(there) = parsed(msg::Packing::DEFINITION).compare(&parsed(&definition)) else {
        panic!("not in another order")
    };
    let payload = there.apply(&to_cdr(&message_of(&packing))).unwrap();
    let file = written(root.path(), &definition, &payload);
    let read = load(&file, &ImportOptions::default()).unwrap().packings.remove(0);
    assert_eq!(read.packing, packing);
    assert!(read.notes[0].contains("another order"), "{:?}", read.notes);
    let recording = Recording::open(&file).unwrap();
    let info = recording.info();
    assert_eq!((info.topics[0].definition, info.definitions.len()), ("mapped", 1));
    assert!(info.to_string().contains("read by the names"), "{info}");
    // A player sends messages of this program.
    let message = recording.messages(&Selection::topics(["/packing"])).unwrap().next().unwrap();
    assert_eq!(*message.own_bytes().unwrap(), to_cdr(&message_of(&packing)));
    let check = recording.check();
    assert!(!check.refused && check.definitions.len() == 1 && check.warnings.is_empty());
}

#[test]
fn a_definition_with_a_renamed_field_is_refused_by_name_although_the_bytes_would_fit() {
    let root = tempfile::tempdir().unwrap();
    let payload = to_cdr(&message_of(&two_grains()));
    let definition = msg::Packing::DEFINITION.replace(" shear_modulus", " youngs_modulus");
    let file = written(root.path(), &definition, &payload);
    let error = load(&file, &ImportOptions::default()).unwrap_err().to_string();
    assert!(error.contains("Packing has no field shear_modulus"), "{error}");
    let recording = Recording::open(&file).unwrap();
    assert!(recording.check().refused);
    assert_eq!(recording.info().topics[0].definition, "refused");
}

#[test]
fn a_run_of_an_earlier_version_goes_on_in_a_file_with_the_definitions_of_this_one() {
    let root = tempfile::tempdir().unwrap();
    let packing = two_grains();
    let (own, later) = (to_cdr(&message_of(&packing)), to_cdr(&message_of(&Packing { step: 9, ..packing })));
    let is_path = |line: &str| line.split_whitespace().take(2).eq(["PathPosition[]", "path"]);
    let lines = msg::Packing::DEFINITION.split_inclusive('\n');
    let earlier: String = lines.filter(|line| !is_path(line)).collect();
    let parsed = |text: &str| Schema::parse(msg::Packing::TYPE, text).unwrap();
    let Comparison::Mapped(there) = parsed(msg::Packing::DEFINITION).compare(&parsed(&earlier)) else {
        panic!("the definitions do not differ")
    };
    let topic = Topic::by_name(topics::PACKING.name).unwrap();
    let spec = TopicSpec::of_contract(topic, "/packing");
    let file = written(root.path(), &earlier, &there.apply(&own).unwrap());
    let directory = file.parent().unwrap();
    for (sequence, payload) in [(2, &later), (3, &own)] {
        // The second time, the recording has both definitions.
        let mut run = RunWriter::append(directory, "run", std::slice::from_ref(&spec), options()).unwrap();
        run.write("/packing", &sample(SIMULATOR, sequence, START, payload)).unwrap();
        run.finish().unwrap();
    }
    let recording = Recording::open(directory).unwrap();
    let all: Vec<_> = recording.messages(&Selection::default()).unwrap().collect();
    let read: Vec<_> = all.iter().map(|message| message.own_bytes().unwrap().into_owned()).collect();
    assert_eq!(read, [own.clone(), later, own]);
    assert_eq!(recording.check().warnings, []);
    let renamed = TopicSpec { definition: spec.definition.replace(" shear_modulus", " modulus"), ..spec };
    let refused = RunWriter::append(directory, "run", &[renamed], options()).err().unwrap().to_string();
    assert!(refused.contains("already recorded with another type"), "{refused}");
}
