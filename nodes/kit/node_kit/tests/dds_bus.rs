//! The bus over DDS: two participants in one process, on loopback, in a separate domain.

use grainlab_msgs::msg::{RunState, StrainRate};
use grainlab_msgs::rcl_interfaces::Log;
use grainlab_msgs::{Qos, Topic, topics};
use grainlab_node_kit::{
    Bus, BusError, DdsBus, Demand, FreeDomain, Graph, Names, Network, Publisher, Statistics, Subscription,
    Wake,
};
use std::time::{Duration, Instant};

/// Far above the time for discovery on an idle machine (0.2 s), so that the test passes on a loaded one.
const TIME_LIMIT: Duration = Duration::from_secs(20);

fn claim() -> FreeDomain {
    FreeDomain::take().expect("a free DDS domain")
}

fn open(network: Network, node: &str) -> DdsBus {
    DdsBus::open(network, Names::in_namespace(node, "/lab").unwrap()).unwrap()
}

/// Two buses in a domain of their own, which lasts as long as its claim.
fn two() -> (FreeDomain, DdsBus, DdsBus) {
    let claimed = claim();
    let (a, b) = (open(claimed.network(), "a"), open(claimed.network(), "b"));
    (claimed, a, b)
}

/// Strain rates that `a` publishes and `b` takes.
fn rates(
    a: &mut DdsBus,
    b: &mut DdsBus,
    demand: Demand,
) -> (Publisher<StrainRate>, Subscription<StrainRate>) {
    let publisher = Publisher::advertise(a, &topics::STRAIN_RATE).unwrap();
    let subscription = Subscription::subscribe(b, &topics::STRAIN_RATE, demand).unwrap();
    until(a, "a sees a reader", |a| a.readers(publisher.id()) == 1);
    until(b, "b sees a writer", |b| b.writers(subscription.id()) == 1);
    (publisher, subscription)
}

/// Waits on `bus` until `done`.
fn until(bus: &mut DdsBus, what: &str, mut done: impl FnMut(&mut DdsBus) -> bool) {
    let start = Instant::now();
    while !done(bus) {
        assert!(start.elapsed() < TIME_LIMIT, "not within {TIME_LIMIT:?}: {what}");
        bus.wait(Duration::from_millis(20));
    }
}

fn state(step: u64) -> RunState {
    RunState { step, ..RunState::default() }
}

fn rate(sequence: u64) -> StrainRate {
    StrainRate { sequence, ..StrainRate::default() }
}

#[test]
fn samples_arrive_once_in_order_with_sequence_numbers_and_the_writers_id() {
    let (_domain, mut a, mut b) = two();
    let (publisher, subscription) = rates(&mut a, &mut b, Demand::reliable(1000));

    let before = b.wall_nanos();
    for n in 1..=300 {
        assert_eq!(publisher.publish(&mut a, &rate(n)).unwrap(), n as i64);
    }
    let ours = a.published()[0].clone();
    assert_eq!((ours.topic.as_str(), ours.count, ours.full), ("/lab/strain_rate", 300, 0));
    let mut next = 1;
    until(&mut b, "300 samples", |b| {
        while let Some((message, info)) = subscription.take_valid(b).unwrap() {
            assert_eq!((message.sequence, info.sequence), (next, next as i64));
            assert_eq!(info.writer, ours.writer);
            // RTPS times have a resolution of 0.23 ns, rounded to 1 ns.
            assert!(
                info.received + 1 >= info.source_time.expect("our writers stamp") && info.received >= before
            );
            next += 1;
        }
        next == 301
    });
    assert_eq!(b.received()[0].taken, 300);
    assert_eq!(b.foreign_writers(&topics::STRAIN_RATE), [ours.writer]);
    assert!(a.foreign_writers(&topics::STRAIN_RATE).is_empty(), "our own writer is not foreign");
    assert!(a.flush(TIME_LIMIT), "all acknowledged");
}

#[test]
fn a_late_joiner_gets_what_was_latched_with_its_first_sequence_numbers() {
    let claimed = claim();
    let network = claimed.network();
    let mut a = open(network, "a");
    let publisher = Publisher::<RunState>::advertise(&mut a, &topics::RUN_STATE).unwrap();
    publisher.publish(&mut a, &state(7)).unwrap();
    publisher.publish(&mut a, &state(8)).unwrap();

    let mut late = open(network, "late");
    let latched =
        Subscription::<RunState>::subscribe(&mut late, &topics::RUN_STATE, Demand::reliable(10)).unwrap();
    let mut last = None;
    until(&mut late, "the latched state", |b| {
        while let Some((message, info)) = latched.take_valid(b).unwrap() {
            last = Some((message.step, info.sequence));
        }
        last == Some((8, 2))
    });
    publisher.publish(&mut a, &state(9)).unwrap();
    until(&mut late, "the new state", |b| latched.take_valid(b).unwrap().is_some_and(|(m, _)| m.step == 9));
}

#[test]
fn packings_of_megabytes_arrive_whole_live_and_latched() {
    const SIZE: usize = 2_000_000;
    let claimed = claim();
    let network = claimed.network();
    let (mut a, mut b) = (open(network, "a"), open(network, "b"));
    let publisher = a.advertise(&topics::PACKING).unwrap();
    let live = b.subscribe(&topics::PACKING, Demand::reliable(10)).unwrap();
    until(&mut b, "match", |b| b.writers(live) == 1);
    until(&mut a, "match", |a| a.readers(publisher) == 1);
    let body: Vec<u8> = [0, 1, 0, 0].into_iter().chain((0..SIZE).map(|i| (i * 7 + i / 251) as u8)).collect();
    let whole = |bus: &mut DdsBus, id, what: &str| {
        let start = Instant::now();
        until(bus, what, |bus| bus.take(id).unwrap().is_some_and(|s| s.body == body));
        println!("{what}: {:?}", start.elapsed());
    };
    a.publish(publisher, &body).unwrap();
    whole(&mut b, live, "the live one");
    let mut late = open(network, "late");
    let latched = late.subscribe(&topics::PACKING, Demand::reliable(10)).unwrap();
    whole(&mut late, latched, "the latched one, discovery included");
}

#[test]
fn a_clean_leave_is_seen_at_once_and_its_last_samples_are_kept() {
    let (_domain, mut a, mut b) = two();
    let (publisher, subscription) = rates(&mut a, &mut b, Demand::reliable(1000));
    for n in 1..=50 {
        publisher.publish(&mut a, &rate(n)).unwrap();
    }
    assert!(a.flush(TIME_LIMIT));
    // The node of b computes: it does not use its bus while a lingers and leaves.
    std::thread::sleep(Duration::from_millis(300));
    drop(a);
    let left = Instant::now();
    std::thread::sleep(Duration::from_millis(300));
    let mut got = 0;
    until(&mut b, "the leave", |b| {
        while subscription.take_valid(b).unwrap().is_some() {
            got += 1;
        }
        b.writers(subscription.id()) == 0
    });
    // A crashed peer stays for up to 50 s; this one left in order.
    assert!(left.elapsed() < Duration::from_secs(5));
    assert_eq!(got, 50, "what was received before the writer left is still delivered");
    assert!(b.foreign_writers(&topics::STRAIN_RATE).is_empty());
}

#[test]
fn waiting_blocks_until_data_and_returns_on_time_without_it() {
    let (_domain, mut a, mut b) = two();
    let (publisher, subscription) = rates(&mut a, &mut b, Demand::best_effort(10));
    while subscription.take_valid(&mut b).unwrap().is_some() {}
    while b.wait(Duration::from_millis(300)) != Wake::Timeout {
        while subscription.take_valid(&mut b).unwrap().is_some() {}
    }
    let start = Instant::now();
    assert_eq!(b.wait(Duration::from_millis(200)), Wake::Timeout);
    assert!(start.elapsed() >= Duration::from_millis(200));

    let writer = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(200));
        publisher.publish(&mut a, &rate(1)).unwrap();
        std::thread::sleep(Duration::from_millis(500));
    });
    let cpu = cpu_time();
    let start = Instant::now();
    assert_eq!(b.wait(TIME_LIMIT), Wake::Data);
    assert!(start.elapsed() < Duration::from_secs(5));
    // A spinning wait would use 200 ms of CPU time; a blocking one needs a few wakeups of the threads below.
    assert!(cpu_time() - cpu < Duration::from_millis(100));
    assert_eq!(b.wait(TIME_LIMIT), Wake::Data, "untaken data is reported again");
    assert!(subscription.take_valid(&mut b).unwrap().is_some());
    writer.join().unwrap();
}

#[test]
fn each_of_two_subscriptions_to_one_topic_gets_everything() {
    let (_domain, mut a, mut b) = two();
    let publisher = Publisher::<StrainRate>::advertise(&mut a, &topics::STRAIN_RATE).unwrap();
    let subscribe =
        |b: &mut DdsBus, demand| Subscription::<StrainRate>::subscribe(b, &topics::STRAIN_RATE, demand);
    let strong = subscribe(&mut b, Demand::reliable(1000)).unwrap();
    let weak = subscribe(&mut b, Demand::best_effort(100)).unwrap();
    until(&mut b, "match", |b| b.writers(strong.id()) == 1 && b.writers(weak.id()) == 1);
    until(&mut a, "match", |a| a.readers(publisher.id()) == 2);
    for n in 1..=20 {
        publisher.publish(&mut a, &rate(n)).unwrap();
    }
    let (mut first, mut second) = (Vec::new(), Vec::new());
    until(&mut b, "20 samples for both", |b| {
        while let Some((m, _)) = weak.take_valid(b).unwrap() {
            second.push(m.sequence);
        }
        while let Some((m, _)) = strong.take_valid(b).unwrap() {
            first.push(m.sequence);
        }
        first.len() == 20 && second.len() == 20
    });
    assert_eq!(first, (1..=20).collect::<Vec<u64>>());
    assert_eq!(second, first);
}

#[test]
fn bodies_that_are_not_messages_are_refused_on_both_sides() {
    let (_domain, mut a, mut b) = two();
    let id = a.advertise(&topics::STRAIN_RATE).unwrap();
    for bad in [&[][..], &[0, 1], &[0, 3, 0, 0, 1], b"text"] {
        assert!(matches!(a.publish(id, bad), Err(BusError::Encapsulation { .. })), "{bad:?}");
    }
    let subscription =
        Subscription::<StrainRate>::subscribe(&mut b, &topics::STRAIN_RATE, Demand::reliable(10)).unwrap();
    until(&mut b, "match", |b| b.writers(subscription.id()) == 1);
    until(&mut a, "match", |a| a.readers(id) == 1);
    a.publish(id, &[0, 1, 0, 0, 9, 9, 9, 9]).unwrap();
    a.publish(id, &grainlab_msgs::to_cdr(&rate(5))).unwrap();
    let mut good = None;
    until(&mut b, "the valid one behind it", |b| {
        good = good.or(subscription.take_valid(b).unwrap().map(|(m, info)| (m.sequence, info.sequence)));
        good.is_some()
    });
    assert_eq!(good, Some((5, 2)));
    assert_eq!((b.received()[0].taken, b.received()[0].refused), (2, 1));
}

#[test]
fn bodies_of_both_byte_orders_arrive_as_they_were_sent_on_a_topic_of_any_type() {
    let (_domain, mut a, mut b) = two();
    let qos = Qos { reliable: true, depth: 50, transient_local: true };
    let topic =
        Topic::outside_contract("/arm/_action/feedback", "demo_msgs/action/Move_Feedback", qos).unwrap();
    let id = a.advertise(&topic).unwrap();
    let offer = |b: &DdsBus| b.offers().into_iter().find(|o| o.topic == topic.name);
    until(&mut b, "the offer", |b| offer(b).is_some());
    let offered = offer(&b).unwrap();
    assert_eq!(offered.type_name, topic.info.type_name);
    assert!(offered.qos.reliable && offered.qos.transient_local, "{offered:?}");
    let subscription = b.subscribe(&topic, Demand::reliable(50)).unwrap();
    until(&mut a, "match", |a| a.readers(id) == 1);
    // One of several datagrams, too.
    let bodies: Vec<Vec<u8>> = [8, 8, 200_000, 200_000]
        .iter()
        .enumerate()
        .map(|(n, length)| [vec![0, n as u8 % 2, 0, 0], vec![n as u8 + 1; *length]].concat())
        .collect();
    for body in &bodies {
        a.publish(id, body).unwrap();
    }
    let mut received = Vec::new();
    until(&mut b, "all of them", |b| {
        while let Some(sample) = b.take(subscription).unwrap() {
            received.push(sample.body);
        }
        received.len() == bodies.len()
    });
    assert!(received == bodies);
    drop(a);
    until(&mut b, "the end of the offer", |b| offer(b).is_none());
}

#[test]
fn the_ros_graph_shows_the_node_and_its_endpoints() {
    use ros2_client::entities_info::ParticipantEntitiesInfo;
    use ros2_client::qos::{Durability, History, WhenFull};
    use ros2_client::{MessageTypeName, NodeName, NodeOptions, QosProfile};
    let claimed = claim();
    let network = claimed.network();
    let mut a = open(network, "talker");
    a.advertise(&topics::STRESS).unwrap();
    a.subscribe(&topics::STRAIN_RATE, Demand::reliable(10)).unwrap();

    let context = network.context().unwrap();
    let mut spy = context.new_node(NodeName::new("/", "spy").unwrap(), NodeOptions::new()).unwrap();
    let qos = QosProfile::publisher_default()
        .reliability_reliable(WhenFull::DEFAULT)
        .durability(Durability::TransientLocal)
        .history(History::KeepLast { depth: 1 });
    let message_type = MessageTypeName::new("rmw_dds_common", "ParticipantEntitiesInfo");
    let topic = context.create_topic("ros_discovery_info".into(), message_type, &qos).unwrap();
    let reader = spy.create_subscription::<ParticipantEntitiesInfo>(&topic, Some(qos)).unwrap();
    let mut nodes = Vec::new();
    until(&mut a, "the node in the graph", |_| {
        while let Ok(Some((info, _))) = reader.take() {
            let all: Vec<String> = info.nodes().iter().map(|n| format!("{n:?}")).collect();
            nodes.extend(all.into_iter().filter(|n| n.contains("talker")));
        }
        !nodes.is_empty()
    });
    let stress = a.published()[0].writer.to_string();
    let latest = nodes.last().unwrap();
    assert!(latest.contains("/lab"), "{latest}");
    assert!(latest.contains(&stress), "the writer of stress, {stress}, in {latest}");
}

/// Processor time of this process, all threads.
fn cpu_time() -> Duration {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
    let ticks: u64 = fields[11].parse::<u64>().unwrap() + fields[12].parse::<u64>().unwrap();
    Duration::from_millis(ticks * 10)
}

#[test]
fn a_process_receives_its_own_messages_once_for_any_demand() {
    let claimed = claim();
    let (mut bus, mut peer) = (open(claimed.network(), "recorder"), open(claimed.network(), "peer"));
    let strong =
        Subscription::<RunState>::subscribe(&mut bus, &topics::RUN_STATE, Demand::reliable(100)).unwrap();
    let weak =
        Subscription::<RunState>::subscribe(&mut bus, &topics::RUN_STATE, Demand::best_effort(100)).unwrap();
    let publisher = Publisher::<RunState>::advertise(&mut bus, &topics::RUN_STATE).unwrap();
    // Long enough for a multicast copy of the own samples, if any, to arrive, too.
    let there =
        Subscription::<RunState>::subscribe(&mut peer, &topics::RUN_STATE, Demand::reliable(100)).unwrap();
    until(&mut bus, "match", |b| b.readers(publisher.id()) == 1);
    for step in 1..=20 {
        publisher.publish(&mut bus, &state(step)).unwrap();
    }
    let mut far = Vec::new();
    until(&mut peer, "20 samples", |b| {
        far.extend(std::iter::from_fn(|| there.take_valid(b).unwrap()).map(|(m, _)| m.step));
        far.len() == 20
    });
    for subscription in [strong, weak] {
        let heard: Vec<u64> =
            std::iter::from_fn(|| subscription.take_valid(&mut bus).unwrap()).map(|(m, _)| m.step).collect();
        assert_eq!(heard, far);
    }
}

#[test]
fn a_node_that_reads_its_own_topic_does_not_wait_for_itself_when_it_leaves() {
    let (_domain, mut a, mut b) = two();
    a.subscribe(&topics::DIAGNOSTICS, Demand::reliable(1000)).unwrap();
    let both = [&topics::DIAGNOSTICS, &topics::STRAIN_RATE].map(|topic| {
        let subscription = b.subscribe(topic, Demand::reliable(1000)).unwrap();
        (a.advertise(topic).unwrap(), subscription)
    });
    for (publisher, subscription) in both {
        until(&mut b, "match", |b| b.writers(subscription) == 1);
        until(&mut a, "match", |a| a.readers(publisher) == 1);
        a.publish(publisher, &grainlab_msgs::to_cdr(&rate(1))).unwrap();
    }
    assert!(a.flush(TIME_LIMIT), "strain_rate, which only the other process reads, is acknowledged");
}

#[test]
fn a_process_takes_its_own_samples_after_those_that_arrived_before() {
    let (_domain, mut a, mut b) = two();
    let rosout = Subscription::<Log>::subscribe(&mut a, &topics::ROSOUT, Demand::reliable(10)).unwrap();
    let [ours, theirs] =
        [&mut a, &mut b].map(|bus| Publisher::<Log>::advertise(bus, &topics::ROSOUT).unwrap());
    until(&mut b, "b sees a reader", |b| b.readers(theirs.id()) == 1);
    let line = |msg: &str| Log { msg: msg.into(), ..Log::default() };
    theirs.publish(&mut b, &line("theirs")).unwrap();
    assert!(b.flush(TIME_LIMIT), "it arrived, and was not taken");
    ours.publish(&mut a, &line("ours")).unwrap();
    let taken: Vec<String> =
        std::iter::from_fn(|| rosout.take_valid(&mut a).unwrap()).map(|(l, _)| l.msg).collect();
    assert_eq!(taken, ["theirs", "ours"]);
}

#[test]
fn a_burst_of_small_samples_waits_beyond_the_depth_of_a_reader() {
    const SAMPLES: i64 = 4000;
    let (_domain, mut a, mut b) = two();
    let publisher = a.advertise(&topics::STRAIN_RATE).unwrap();
    let subscription = b.subscribe(&topics::STRAIN_RATE, Demand::reliable(10).with_burst(5000)).unwrap();
    until(&mut a, "a sees a reader", |a| a.readers(publisher) == 1);
    until(&mut a, "the reader knows the writer", |a| a.is_known_to_readers(publisher));
    for _ in 0..SAMPLES {
        a.publish(publisher, &[0, 1, 0, 0, 7, 7, 7, 7]).unwrap();
    }
    until(&mut a, "all acknowledged", |a| a.unacknowledged(publisher) == 0);
    let mut taken = Vec::new();
    until(&mut b, "the last sample", |b| {
        while let Some(sample) = b.take(subscription).unwrap() {
            taken.push(sample.info.sequence);
        }
        taken.last() == Some(&SAMPLES)
    });
    assert!(taken.into_iter().eq(1..=SAMPLES));
}
