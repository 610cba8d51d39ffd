//! Messages of any length on the bus in memory.

use crate::{MS, bus_of};
use grainlab_msgs::topics;
use grainlab_node_kit::{
    BULK_LIMIT, BulkPublisher, BulkSubscription, Bus, BusError, Demand, Faults, Hub, MemoryBus, Names,
    Sample, Statistics,
};

/// A body that is different for each `n`.
fn body(n: u8, length: usize) -> Vec<u8> {
    let mut bytes: Vec<u8> = (0..length).map(|i| (i / 251) as u8 ^ (i as u8).wrapping_mul(n | 1)).collect();
    bytes[..4].copy_from_slice(&[0, 1, 0, 0]);
    bytes[4] = n;
    bytes
}

struct Writer {
    bus: MemoryBus,
    publisher: BulkPublisher,
}

struct Reader {
    bus: MemoryBus,
    subscription: BulkSubscription,
    samples: Vec<Sample>,
}

impl Reader {
    fn numbers(&self) -> Vec<u8> {
        self.samples.iter().map(|sample| sample.body[4]).collect()
    }
}

fn writer(hub: &Hub) -> Writer {
    let mut bus = bus_of(hub, "writer");
    let publisher = BulkPublisher::advertise(&mut bus, &topics::PACKING).unwrap();
    Writer { bus, publisher }
}

fn reader(hub: &Hub, name: &str) -> Reader {
    let mut bus = bus_of(hub, name);
    let subscription = BulkSubscription::subscribe(&mut bus, &topics::PACKING, Demand::reliable(64)).unwrap();
    Reader { bus, subscription, samples: Vec::new() }
}

/// Lets all nodes receive, then a millisecond pass; returns whether no message is in transit.
fn tick(hub: &Hub, writer: &mut Writer, readers: &mut [Reader]) -> bool {
    let idle = writer.publisher.advance(&mut writer.bus).unwrap();
    for reader in readers {
        while let Some(sample) = reader.subscription.take(&mut reader.bus).unwrap() {
            reader.samples.push(sample);
        }
    }
    hub.advance(MS);
    idle
}

fn pass(hub: &Hub, writer: &mut Writer, readers: &mut [Reader], milliseconds: u32) {
    for _ in 0..milliseconds {
        tick(hub, writer, readers);
    }
}

fn publish(hub: &Hub, writer: &mut Writer, readers: &mut [Reader], body: &[u8]) {
    for _ in 0..60_000 {
        match writer.publisher.publish(&mut writer.bus, body) {
            Ok(()) => return,
            Err(BusError::Full { .. }) => pass(hub, writer, readers, 1),
            Err(error) => panic!("{error}"),
        }
    }
    panic!("the body before is not delivered within a minute");
}

fn deliver(hub: &Hub, writer: &mut Writer, readers: &mut [Reader]) {
    assert!((0..60_000).any(|_| tick(hub, writer, readers)), "not delivered within a minute");
    pass(hub, writer, readers, 200);
}

#[test]
fn a_message_up_to_the_limit_is_one_sample_of_the_plain_topic_with_the_same_bytes() {
    let hub = Hub::new(1);
    let mut readers = [reader(&hub, "a")];
    let mut plain = bus_of(&hub, "plain");
    let listener = plain.subscribe(&topics::PACKING, Demand::reliable(9)).unwrap();
    let mut writer = writer(&hub);
    for length in [100, BULK_LIMIT] {
        let body = body(1, length);
        publish(&hub, &mut writer, &mut readers, &body);
        deliver(&hub, &mut writer, &mut readers);
        let heard = plain.take(listener).unwrap().unwrap();
        let got = readers[0].samples.pop().unwrap();
        assert!(heard.body == body && got == heard);
    }
    let counts: Vec<(String, u64)> = writer.bus.published().into_iter().map(|p| (p.topic, p.count)).collect();
    assert_eq!(counts, [("/lab/packing".into(), 2), ("/lab/packing_chunk".into(), 0)]);
}

#[test]
fn large_and_small_messages_arrive_whole_and_in_order_at_every_reader_on_a_bad_network() {
    for seed in 0..10 {
        let hub = Hub::new(seed);
        let faults = Faults { drop: 0.2, duplicate: 0.2, delay: 15 * MS };
        hub.set_faults("/lab/packing_chunk", faults);
        hub.set_faults("/lab/packing_credit", faults);
        let mut readers = [reader(&hub, "a"), reader(&hub, "b")];
        let mut writer = writer(&hub);
        let lengths = [BULK_LIMIT + 1, 700, 700, 3 * BULK_LIMIT, BULK_LIMIT + 70_000, 60];
        for (n, length) in (1..).zip(lengths) {
            publish(&hub, &mut writer, &mut readers, &body(n, length));
        }
        deliver(&hub, &mut writer, &mut readers);
        for reader in &readers {
            assert_eq!(reader.numbers(), [1, 2, 3, 4, 5, 6], "seed {seed}");
            for (sample, (n, length)) in reader.samples.iter().zip((1..).zip(lengths)) {
                assert!(sample.body == body(n, length), "seed {seed}, message {n}");
            }
        }
    }
}

#[test]
fn large_messages_count_as_published_on_the_topic_and_carry_their_own_sequence() {
    let hub = Hub::new(2);
    let mut readers = [reader(&hub, "a")];
    let mut writer = writer(&hub);
    for (n, length) in [(1, BULK_LIMIT + 1), (2, 50), (3, BULK_LIMIT + 2)] {
        publish(&hub, &mut writer, &mut readers, &body(n, length));
    }
    deliver(&hub, &mut writer, &mut readers);
    let published = writer.bus.published();
    let whole: Vec<_> = published.iter().filter(|p| p.topic == "/lab/packing").collect();
    assert_eq!(whole.iter().map(|p| p.count).collect::<Vec<_>>(), [1, 2], "one plain, two in parts");
    let seen: Vec<_> =
        readers[0].samples.iter().map(|sample| (sample.info.writer, sample.info.sequence)).collect();
    assert_eq!(seen, [(whole[1].writer, 1), (whole[0].writer, 1), (whole[1].writer, 2)]);
}

#[test]
fn a_late_reader_gets_the_latest_message_whichever_way_it_went() {
    let hub = Hub::new(3);
    let mut readers = vec![reader(&hub, "a")];
    let mut writer = writer(&hub);
    publish(&hub, &mut writer, &mut readers, &body(1, BULK_LIMIT + 1));
    publish(&hub, &mut writer, &mut readers, &body(2, 2 * BULK_LIMIT));
    deliver(&hub, &mut writer, &mut readers);
    readers.push(reader(&hub, "late"));
    pass(&hub, &mut writer, &mut readers, 2000);
    assert_eq!(readers[1].numbers(), [2]);
    publish(&hub, &mut writer, &mut readers, &body(3, 1000));
    deliver(&hub, &mut writer, &mut readers);
    readers.push(reader(&hub, "later"));
    pass(&hub, &mut writer, &mut readers, 2000);
    assert_eq!(readers[2].numbers(), [3]);
    assert_eq!(readers[0].numbers(), [1, 2, 3]);
}

#[test]
fn a_reader_with_much_to_take_holds_large_messages_back_and_loses_none() {
    let hub = Hub::new(5);
    let mut slow = reader(&hub, "slow");
    let mut writer = writer(&hub);
    let bodies: Vec<Vec<u8>> = (1..=5).map(|n| body(n, 30 << 20)).collect();
    let mut published = 0;
    // It receives, but takes nothing.
    for _ in 0..5_000 {
        slow.subscription.advance(&mut slow.bus).unwrap();
        match writer.publisher.publish(&mut writer.bus, &bodies[published]) {
            Ok(()) => published += 1,
            Err(BusError::Full { .. }) => {}
            Err(error) => panic!("{error}"),
        }
        hub.advance(MS);
    }
    assert!(
        slow.subscription.waiting() == 3 && published == 4,
        "{} {published}",
        slow.subscription.waiting()
    );
    let mut readers = [slow];
    publish(&hub, &mut writer, &mut readers, &bodies[4]);
    deliver(&hub, &mut writer, &mut readers);
    assert_eq!(readers[0].numbers(), [1, 2, 3, 4, 5]);
}

#[test]
fn parts_of_a_remapped_topic_are_beside_it() {
    let hub = Hub::new(6);
    let mut readers = [reader(&hub, "a")];
    let arguments = ["--ros-args", "-r", "packing:=other"].map(String::from);
    let (ros, _) = grainlab_node_kit::RosArgs::parse(&arguments).unwrap();
    let mut bus = hub.bus(Names::from_args("writer", &ros).unwrap());
    let publisher = BulkPublisher::advertise(&mut bus, &topics::PACKING).unwrap();
    let mut writer = Writer { bus, publisher };
    publish(&hub, &mut writer, &mut readers, &body(1, BULK_LIMIT + 1));
    deliver(&hub, &mut writer, &mut readers);
    let names: Vec<String> = writer.bus.published().into_iter().map(|p| p.topic).collect();
    assert_eq!(names, ["/other", "/other", "/other_chunk"]);
    assert!(readers[0].samples.is_empty());
}
