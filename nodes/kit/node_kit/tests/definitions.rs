//! Writers whose messages have another definition than those of the reader: they are not read by position.

use grainlab_msgs::{Topic, TypeInfo, topics};
use grainlab_node_kit::{
    BULK_LIMIT, BulkPublisher, BulkSubscription, Bus, DdsBus, Demand, FreeDomain, Graph, Names, Statistics,
};
use std::time::{Duration, Instant};

/// Far above the time for discovery on an idle machine (0.2 s), so that the test passes on a loaded one.
const TIME_LIMIT: Duration = Duration::from_secs(20);

/// The hash of no type.
const OTHER: &str = "RIHS01_0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f0f";

/// A topic as a program has it whose definition of the type differs.
fn changed(topic: &Topic) -> Topic {
    Topic { info: TypeInfo { hash: OTHER, ..topic.info }, ..*topic }
}

fn open(claimed: &FreeDomain, node: &str) -> DdsBus {
    DdsBus::open(claimed.network(), Names::new(node).unwrap()).unwrap()
}

fn body(number: u8, length: usize) -> Vec<u8> {
    let mut body = vec![number; length];
    body[..4].copy_from_slice(&[0, 1, 0, 0]);
    body
}

#[test]
fn a_writer_of_another_definition_or_type_is_refused_and_counted_and_one_of_the_same_is_read() {
    let claimed = FreeDomain::take().expect("a free DDS domain");
    let (mut reader, mut writer) = (open(&claimed, "reader"), open(&claimed, "writer"));
    // Every type of the laboratory.
    let all: Vec<&Topic> = topics::TOPICS.iter().filter(|t| t.info.package == "grainlab_msgs").collect();
    for topic in &all {
        let subscription = reader.subscribe(topic, Demand::reliable(16)).unwrap();
        let other_type =
            if topic.info == topics::STRESS.info { topics::MODULI.info } else { topics::STRESS.info };
        let [good, bad, wrong] = [**topic, changed(topic), Topic { info: other_type, ..**topic }]
            .map(|t| writer.advertise(&t).unwrap());
        let ours = &writer.published()[writer.published().len() - 3].clone();
        let begin = Instant::now();
        // The writers that do not fit do not count as writers of the topic.
        while reader.offers().iter().filter(|o| o.topic == topic.absolute_name()).count() < 3
            || writer.readers(good) < 1
            || reader.writers(subscription) != 1
        {
            assert!(begin.elapsed() < TIME_LIMIT, "{}: {} writers", topic.name, reader.writers(subscription));
            reader.wait(Duration::from_millis(20));
            writer.wait(Duration::from_millis(20));
        }
        assert_eq!(reader.foreign_writers(topic), [ours.writer]);
        assert_eq!(reader.misfits(topic).len(), 2);
        let offers = reader.offers();
        let announced = offers.iter().find(|o| o.writer == ours.writer).unwrap();
        assert_eq!(announced.type_hash, topic.info.hash, "a node announces the definitions that it writes");
        for (publisher, number) in [(bad, 7), (wrong, 8), (good, 9)] {
            writer.publish(publisher, &body(number, 64)).unwrap();
        }
        let mut taken = Vec::new();
        let refused = |reader: &DdsBus| reader.received().last().unwrap().refused;
        while taken.is_empty() || (topic.qos.reliable && refused(&reader) < 2) {
            assert!(begin.elapsed() < TIME_LIMIT, "{}: {taken:?}, {} refused", topic.name, refused(&reader));
            reader.wait(Duration::from_millis(20));
            while let Some(sample) = reader.take(subscription).unwrap() {
                taken.push((sample.info.writer, sample.body[8]));
            }
        }
        assert_eq!(taken, [(ours.writer, 9)], "{}", topic.name);
    }
}

#[test]
fn the_parts_of_a_large_packing_of_another_definition_are_refused_too() {
    let claimed = FreeDomain::take().expect("a free DDS domain");
    let (mut reader, mut writer) = (open(&claimed, "reader"), open(&claimed, "writer"));
    let mut packings =
        BulkSubscription::subscribe(&mut reader, &topics::PACKING, Demand::reliable(4)).unwrap();
    let mut bad = BulkPublisher::advertise(&mut writer, &changed(&topics::PACKING)).unwrap();
    let begin = Instant::now();
    while reader.misfits(&topics::PACKING).is_empty() || writer.readers(bad.id()) < 1 {
        assert!(begin.elapsed() < TIME_LIMIT);
        reader.wait(Duration::from_millis(20));
        writer.wait(Duration::from_millis(20));
    }
    bad.publish(&mut writer, &body(3, BULK_LIMIT + 1)).unwrap();
    let refused = |reader: &DdsBus| reader.received().iter().map(|r| r.refused).sum::<u64>();
    while refused(&reader) < 3 {
        assert!(begin.elapsed() < TIME_LIMIT, "{} parts refused", refused(&reader));
        bad.advance(&mut writer).unwrap();
        writer.wait(Duration::from_millis(5));
        assert!(packings.take(&mut reader).unwrap().is_none());
        reader.wait(Duration::from_millis(5));
    }
}
