use super::*;
use crate::{Recorder, ResultSlot, Settings};
use grainlab_node_kit::{Exit, Faults, Hub, MemoryBus, Names, Node};
use grainlab_recordings::WriterOptions;

const BEST_EFFORT: Qos = Qos { reliable: false, depth: 5, transient_local: false };

fn settings() -> OtherTopics {
    OtherTopics::default()
}

fn bus(hub: &Hub, name: &str) -> MemoryBus {
    hub.bus(Names::new(name).unwrap())
}

fn publish(bus: &mut MemoryBus, name: &str, kind: &str, qos: Qos) {
    bus.advertise(&Topic::outside_contract(name, kind, qos).unwrap()).unwrap();
}

/// All topics found within a second, by name.
fn found(finder: &mut Finder, bus: &mut MemoryBus, known: &BTreeSet<String>) -> BTreeMap<String, FoundTopic> {
    let mut all = BTreeMap::new();
    for _ in 0..10 {
        for found in finder.look(bus, &known.iter().cloned().chain(all.keys().cloned()).collect()) {
            assert!(all.insert(found.spec.name.clone(), found).is_none(), "found twice");
        }
        bus.wait(LOOK);
    }
    all
}

#[test]
fn every_topic_is_found_with_its_type_and_the_qos_that_suits_all_writers() {
    let hub = Hub::new(1);
    let (mut other, mut own) = (bus(&hub, "other"), bus(&hub, "own"));
    publish(&mut other, "/chatter", "demo_msgs/msg/Chat", Qos::STREAM);
    publish(&mut other, "/chatter", "demo_msgs/msg/Chat", BEST_EFFORT);
    publish(&mut other, "/left/stress", "grainlab_msgs/msg/Stress", Qos::LATCHED);
    publish(&mut other, "/arm/_action/status", "action_msgs/msg/GoalStatusArray", Qos::LATCHED);
    publish(&mut other, "/left/packing_chunk", "grainlab_msgs/msg/PackingChunk", Qos::PARTS);
    publish(&mut other, "/known", "std_msgs/msg/String", Qos::STREAM);
    publish(&mut own, "/mine", "std_msgs/msg/String", Qos::STREAM);
    let mut finder = Finder::new(settings());
    let known = BTreeSet::from(["/known".to_owned()]);
    let all = found(&mut finder, &mut own, &known);
    assert_eq!(all.keys().collect::<Vec<_>>(), ["/chatter", "/left/stress"]);

    let chatter = &all["/chatter"];
    assert_eq!((chatter.topic.qos.reliable, chatter.topic.qos.transient_local), (false, false));
    assert_eq!(chatter.spec.ros_type, "demo_msgs/msg/Chat");
    assert_eq!((chatter.spec.schema_encoding.as_str(), chatter.spec.definition.as_str()), ("", ""));
    assert_eq!(chatter.spec.qos.matches("- history").count(), 2, "{}", chatter.spec.qos);
    let stress = &all["/left/stress"];
    assert!(stress.topic.qos.reliable && stress.topic.qos.transient_local);
    let info = grainlab_msgs::topics::STRESS.info;
    assert_eq!(
        (stress.spec.definition.as_str(), stress.spec.type_hash.as_str()),
        (info.definition, info.hash)
    );

    publish(&mut other, "/late", "std_msgs/msg/String", BEST_EFFORT);
    let known = known.into_iter().chain(all.into_keys()).collect();
    assert_eq!(found(&mut finder, &mut own, &known).into_keys().collect::<Vec<_>>(), ["/late"]);
}

#[test]
fn a_topic_of_two_types_is_refused_until_one_is_left() {
    let hub = Hub::new(1);
    let (mut one, mut two, mut own) = (bus(&hub, "one"), bus(&hub, "two"), bus(&hub, "own"));
    publish(&mut one, "/a", "std_msgs/msg/String", Qos::STREAM);
    publish(&mut two, "/a", "std_msgs/msg/Bool", Qos::STREAM);
    let mut finder = Finder::new(settings());
    assert!(found(&mut finder, &mut own, &BTreeSet::new()).is_empty());
    drop(two);
    assert_eq!(found(&mut finder, &mut own, &BTreeSet::new()).len(), 1);
}

#[test]
fn losses_of_a_topic_of_any_type_are_counted_from_its_first_message() {
    let hub = Hub::new(5);
    let (mut other, mut own) = (bus(&hub, "other"), bus(&hub, "own"));
    let topic = Topic::outside_contract("/chatter", "demo_msgs/msg/Any", BEST_EFFORT).unwrap();
    let id = other.advertise(&topic).unwrap();
    let body = [0, 1, 0, 0, 7, 0, 0, 0];
    other.publish(id, &body).unwrap(); // Before the recording.
    let folder = tempfile::tempdir().unwrap();
    let settings = Settings {
        output: Some(folder.path().join("any")),
        topics: Vec::new(),
        others: Some(settings()),
        scene: None,
        whole_run: false,
        writer: WriterOptions::default(),
        append: false,
    };
    let result = ResultSlot::default();
    let mut recorder = Recorder::new(&mut own, &settings, result.clone()).unwrap();
    for _ in 0..5 {
        recorder.step(&mut own).unwrap();
        own.wait(LOOK);
    }
    for lossy in [false, true, false] {
        hub.set_faults("/chatter", Faults { drop: if lossy { 1.0 } else { 0.0 }, ..Faults::default() });
        for _ in 0..10 {
            other.publish(id, &body).unwrap();
        }
        own.wait(LOOK);
        recorder.step(&mut own).unwrap();
    }
    assert_eq!(recorder.on_shutdown(&mut own).unwrap(), Exit::DataLoss);
    let finished = result.borrow_mut().take().unwrap();
    let tallies = finished.ledger.tallies();
    let tally = tallies.iter().find(|t| t.name == "/chatter").unwrap();
    assert_eq!((tally.published, tally.recorded, tally.lost), (30, 20, 10));
}

#[test]
fn a_topic_that_was_found_and_of_which_nothing_came_is_silent() {
    let tally = |name: &str, published: u64| TopicTally {
        name: name.to_owned(),
        published,
        recorded: published,
        lost: 0,
        repeated: 0,
        conflicting: 0,
        redelivered: 0,
        writers: Vec::new(),
    };
    let mut finder = Finder::new(settings());
    finder.found = ["/chatter", "/mute", "/partitioned"].map(str::to_owned).into();
    assert_eq!(finder.silent(&[tally("/chatter", 3), tally("/mute", 0)]), ["/mute", "/partitioned"]);
}
