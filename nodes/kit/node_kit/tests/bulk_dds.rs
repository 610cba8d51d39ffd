//! Large messages over DDS, on loopback, in a separate domain.

use grainlab_msgs::msg::Packing;
use grainlab_msgs::{from_cdr, to_cdr, topics};
use grainlab_node_kit::{
    BULK_LIMIT, BulkPublisher, BulkSubscription, Bus, BusError, DdsBus, Demand, FreeDomain, Graph, Names,
    Network,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

const TIME_LIMIT: Duration = Duration::from_secs(120);

fn open(network: Network, node: &str) -> DdsBus {
    DdsBus::open(network, Names::in_namespace(node, "/lab").unwrap()).unwrap()
}

/// A body as long as a packing of `grains` grains with z = 5, and incompressible.
fn packing(grains: usize) -> Packing {
    let contacts = grains * 5 / 2;
    let mut state = 1_u64;
    let mut number = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64
    };
    let mut numbers = |count: usize| (0..count).map(|_| number()).collect::<Vec<f64>>();
    Packing {
        id: (0..grains as u32).collect(),
        radius: numbers(grains),
        position: numbers(3 * grains),
        velocity: numbers(3 * grains),
        angular_velocity: numbers(3 * grains),
        contact_pair: vec![3; 2 * contacts],
        contact_image: vec![-1; 3 * contacts],
        contact_overlap: numbers(contacts),
        contact_normal: numbers(3 * contacts),
        contact_normal_force: numbers(contacts),
        contact_tangential_force: numbers(3 * contacts),
        run_state: vec![7; 2000],
        scene: "synthetic".into(),
        ..Packing::default()
    }
}

#[test]
fn thirty_of_thirty_packings_of_sixteen_thousand_grains_arrive_intact_at_two_readers_and_at_a_late_one() {
    const PACKINGS: u64 = 30;
    let claimed = FreeDomain::take().expect("a free DDS domain");
    let network = claimed.network();
    let first = packing(16_000);
    assert!(to_cdr(&first).len() > 2 * BULK_LIMIT);
    let body = |step: u64| to_cdr(&Packing { step, time: step as f64, ..first.clone() });
    let stop = Arc::new(AtomicBool::new(false));
    let readers: Vec<_> = (0..2)
        .map(|n| {
            let stop = Arc::clone(&stop);
            std::thread::spawn(move || {
                let mut bus = open(network, &format!("reader_{n}"));
                let mut packings =
                    BulkSubscription::subscribe(&mut bus, &topics::PACKING, Demand::reliable(64)).unwrap();
                let mut bodies = Vec::new();
                while bodies.len() < PACKINGS as usize && !stop.load(Ordering::Relaxed) {
                    while let Some(sample) = packings.take(&mut bus).unwrap() {
                        bodies.push((sample.info.sequence, sample.body));
                    }
                    bus.wait(packings.patience(bus.now()));
                }
                // The last credit has to arrive.
                let end = bus.now() + Duration::from_secs(1);
                while bus.now() < end {
                    packings.advance(&mut bus).unwrap();
                    bus.wait(Duration::from_millis(20));
                }
                bodies
            })
        })
        .collect();

    let mut bus = open(network, "writer");
    let mut publisher = BulkPublisher::advertise(&mut bus, &topics::PACKING).unwrap();
    let begun = Instant::now();
    while bus.readers(publisher.id()) < 2 {
        assert!(begun.elapsed() < TIME_LIMIT, "two readers");
        bus.wait(Duration::from_millis(20));
    }
    let mut took = Vec::new();
    for step in 1..=PACKINGS {
        let body = body(step);
        let begun = Instant::now();
        while let Err(error) = publisher.publish(&mut bus, &body) {
            assert!(matches!(error, BusError::Full { .. }), "{error}");
            assert!(begun.elapsed() < TIME_LIMIT, "packing {step} is not delivered");
            bus.wait(BulkPublisher::patience());
        }
        let sent = Instant::now();
        while !publisher.advance(&mut bus).unwrap() {
            assert!(begun.elapsed() < TIME_LIMIT, "packing {step} is not delivered");
            bus.wait(BulkPublisher::patience());
        }
        took.push(sent.elapsed());
    }
    took.sort();
    println!(
        "a packing of {} bytes, publish to the last credit: median {:?}, longest {:?}",
        body(1).len(),
        took[took.len() / 2],
        took[took.len() - 1]
    );

    let mut late_bus = open(network, "late");
    let mut late =
        BulkSubscription::subscribe(&mut late_bus, &topics::PACKING, Demand::reliable(64)).unwrap();
    let latest = loop {
        assert!(begun.elapsed() < TIME_LIMIT, "the latest packing for a late reader");
        publisher.advance(&mut bus).unwrap();
        if let Some(sample) = late.take(&mut late_bus).unwrap() {
            break sample;
        }
        bus.wait(Duration::from_millis(2));
        late_bus.wait(Duration::from_millis(2));
    };
    assert!(latest.body == body(PACKINGS) && latest.info.sequence == PACKINGS as i64);
    stop.store(true, Ordering::Relaxed);
    for reader in readers {
        let bodies = reader.join().unwrap();
        assert_eq!(bodies.len(), PACKINGS as usize);
        for ((number, got), step) in bodies.iter().zip(1..) {
            assert!(*number == step as i64 && *got == body(step), "packing {step}");
        }
        let message: Packing = from_cdr(&bodies[0].1).unwrap();
        assert_eq!((message.step, message.position.len()), (1, 48_000));
    }
    assert_eq!(publisher.left_behind(), 0);
}

#[test]
fn another_thread_ends_a_wait_and_only_one() {
    let claimed = FreeDomain::take().expect("a free DDS domain");
    let mut bus = open(claimed.network(), "called");
    let caller = bus.caller().expect("real time");
    let calls = Arc::new(AtomicUsize::new(0));
    caller.call();
    let mut wakes = Vec::new();
    let begun = Instant::now();
    while !wakes.contains(&grainlab_node_kit::Wake::Called) {
        assert!(begun.elapsed() < TIME_LIMIT, "the call before the wait");
        wakes.push(bus.wait(Duration::from_secs(3600)));
    }
    let its = Arc::clone(&calls);
    let thread = std::thread::spawn(move || {
        its.fetch_add(1, Ordering::SeqCst);
        caller.call();
    });
    while bus.wait(Duration::from_secs(3600)) != grainlab_node_kit::Wake::Called {
        assert!(begun.elapsed() < TIME_LIMIT, "the call");
    }
    thread.join().unwrap();
    assert_eq!(calls.load(Ordering::SeqCst), 1);
    assert_ne!(bus.wait(Duration::ZERO), grainlab_node_kit::Wake::Called);
}
