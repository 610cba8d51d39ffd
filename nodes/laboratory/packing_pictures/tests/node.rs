//! The node on the bus in memory.

use grainlab_core::{Cell, Packing, Vec3};
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::sensor_msgs::PointCloud2;
use grainlab_msgs::visualization_msgs::MarkerArray;
use grainlab_msgs::{msg, topics};
use grainlab_node_kit::{
    Bus, Demand, Hub, Level, MemoryBus, Names, Node, Publisher, RosArgs, Statistics, Subscription,
};
use grainlab_packing_pictures::PackingPictures;

fn join(hub: &Hub, name: &str) -> MemoryBus {
    hub.bus(Names::from_args(name, &RosArgs::default()).unwrap())
}

/// One grain without contacts.
fn message(step: u64) -> msg::Packing {
    let packing = Packing {
        step,
        time: step as f64,
        ids: vec![5],
        friction: 0.3,
        time_step: 1e-8,
        ..Packing::at_rest(Cell::cube(1.0).unwrap(), vec![0.25], vec![Vec3::new(0.5, 0.5, 0.5)])
    };
    packing_message(&packing.validated().unwrap(), "one grain", vec![])
}

fn published(bus: &dyn Bus) -> Vec<u64> {
    let of = |name: &str| bus.published().iter().find(|p| p.topic == name).unwrap().count;
    vec![of("/packing/points"), of("/packing/markers")]
}

#[test]
fn a_picture_is_made_only_for_its_readers_and_a_late_one_gets_the_latest_state() {
    let hub = Hub::new(1);
    let (mut sender, mut node_bus, mut viewer) =
        (join(&hub, "sender"), join(&hub, "pictures"), join(&hub, "viewer"));
    let packings: Publisher<msg::Packing> = Publisher::advertise(&mut sender, &topics::PACKING).unwrap();
    let mut node = PackingPictures::new(&mut node_bus).unwrap();
    for step in [1, 2] {
        packings.publish(&mut sender, &message(step)).unwrap();
    }
    let mut settle = |bus: &mut MemoryBus| {
        for _ in 0..8 {
            node.step(bus).unwrap();
        }
        node.health().level
    };
    assert_eq!(settle(&mut node_bus), Level::Ok);
    assert_eq!(published(&node_bus), [0, 0], "nobody looks");

    let points: Subscription<PointCloud2> =
        Subscription::subscribe(&mut viewer, &topics::PACKING_POINTS, Demand::reliable(8)).unwrap();
    settle(&mut node_bus);
    assert_eq!(published(&node_bus), [1, 0], "the latest state, and no markers");
    packings.publish(&mut sender, &message(3)).unwrap();
    packings.publish(&mut sender, &message(4)).unwrap();
    settle(&mut node_bus);
    let stamps = std::iter::from_fn(|| points.take_valid(&mut viewer).unwrap());
    let stamps: Vec<i32> = stamps.map(|(m, _)| m.header.stamp.sec - 1_000_000_000).collect();
    assert_eq!(stamps, [2, 3, 4], "each state once, in order");

    let markers: Subscription<MarkerArray> =
        Subscription::subscribe(&mut viewer, &topics::PACKING_MARKERS, Demand::reliable(8)).unwrap();
    settle(&mut node_bus);
    assert_eq!(published(&node_bus), [3, 1]);
    let (last, _) = markers.take_valid(&mut viewer).unwrap().unwrap();
    assert_eq!(last.markers[0].header.stamp.sec, 1_000_000_004);
}

#[test]
fn a_message_that_is_no_packing_is_counted_and_the_next_one_is_drawn() {
    let hub = Hub::new(1);
    let (mut sender, mut node_bus, mut viewer) =
        (join(&hub, "sender"), join(&hub, "pictures"), join(&hub, "viewer"));
    let packings: Publisher<msg::Packing> = Publisher::advertise(&mut sender, &topics::PACKING).unwrap();
    let mut node = PackingPictures::new(&mut node_bus).unwrap();
    viewer.subscribe(&topics::PACKING_POINTS, Demand::reliable(8)).unwrap();
    let bad = msg::Packing { radius: vec![-1.0], ..message(1) };
    packings.publish(&mut sender, &bad).unwrap();
    node.step(&mut node_bus).unwrap();
    assert_eq!(node.health().level, Level::Warn);
    assert!(node.health().message.contains("radius"), "{}", node.health().message);
    assert_eq!(node_bus.received().iter().map(|r| r.refused).sum::<u64>(), 1);
    packings.publish(&mut sender, &message(2)).unwrap();
    node.step(&mut node_bus).unwrap();
    assert_eq!((node.health().level, published(&node_bus)), (Level::Ok, vec![1, 0]));
}
