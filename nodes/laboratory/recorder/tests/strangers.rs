//! Processes on the bus that are not part of a run.

use grainlab_msgs::{msg, to_cdr, topics};
use grainlab_node_kit::{Bus, Exit, Hub, Identity, MemoryBus, Names, Node, RunId};
use grainlab_recorder::{Recorder, ResultSlot, Settings};
use grainlab_recordings::{Recording, WriterOptions, strangers};
use std::path::Path;
use std::time::Duration;

/// A recorder of `/stress` of one run, which continues the recording if there is one.
fn recorder(hub: &Hub, directory: &Path) -> (MemoryBus, Recorder) {
    let settings = Settings {
        output: Some(directory.to_owned()),
        topics: vec![topics::STRESS],
        others: None,
        scene: None,
        whole_run: true,
        writer: WriterOptions::default(),
        append: directory.exists(),
    };
    let mut bus = hub.bus_as(Names::new("recorder").unwrap(), Identity::member_of(RunId::named("mine"), 1));
    let recorder = Recorder::new(&mut bus, &settings, ResultSlot::default()).unwrap();
    (bus, recorder)
}

#[test]
fn a_recorder_that_continues_a_run_keeps_the_strangers_that_the_one_before_it_has_named() {
    let folder = tempfile::tempdir().unwrap();
    let (hub, directory) = (Hub::new(1), folder.path().join("run"));
    let other = Identity::member_of(RunId::named("other"), 1);
    let mut other = hub.bus_as(Names::new("dem_simulator").unwrap(), other);
    let publisher = other.advertise(&topics::STRESS).unwrap();
    for messages in [3, 0, 2] {
        let (mut bus, mut recorder) = recorder(&hub, &directory);
        for _ in 0..messages {
            other.publish(publisher, &to_cdr(&msg::Stress::default())).unwrap();
        }
        hub.advance(Duration::from_secs(1));
        recorder.step(&mut bus).unwrap();
        assert_eq!(recorder.on_shutdown(&mut bus).unwrap(), Exit::Done);
    }
    let strangers = strangers::strangers(&Recording::open(&directory).unwrap());
    assert_eq!(strangers.len(), 1, "{strangers:?}");
    assert_eq!(strangers[0].who, format!("run {}", RunId::named("other")));
    assert_eq!(strangers[0].ignored["/stress"], 5);
}
