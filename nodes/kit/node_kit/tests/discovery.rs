//! The threads of a participant of RustDDS do not wait for each other in a circle.

use grainlab_node_kit::FreeDomain;
use rustdds::{DomainParticipant, DomainParticipantBuilder, QosPolicies, TopicKind};
use std::net::Ipv4Addr;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// More than the queue of notifications from discovery to the event loop holds.
const WRITERS: usize = 100;

type Ends = (SyncSender<()>, Receiver<()>);

/// A place at which a thread waits, once armed.
#[derive(Clone)]
struct Barrier(Arc<Mutex<Option<Ends>>>);

impl Barrier {
    /// Ends of channels: one says that the thread waits, the other lets it go.
    fn arm(&self) -> (Receiver<()>, SyncSender<()>) {
        let ((here, waits), (go, gone)) = (sync_channel(1), sync_channel(1));
        *self.0.lock().unwrap() = Some((here, gone));
        (waits, go)
    }

    fn pass(&self) {
        let armed = self.0.lock().unwrap().take();
        if let Some((here, gone)) = armed {
            here.send(()).unwrap();
            gone.recv().unwrap();
        }
    }
}

/// The event loop is held while discovery notifies it of a participant and of the writers on the topic of a new reader, and the
/// application makes the next reader. Then the event loop goes on.
#[test]
fn a_full_queue_from_discovery_to_the_event_loop_does_not_hold_up_the_application() {
    let claimed = FreeDomain::take().expect("a free DDS domain");
    let domain = claimed.network().domain;
    let builder = move || DomainParticipantBuilder::new(domain).with_only_networks([Ipv4Addr::LOCALHOST]);
    let [in_loop, in_discovery] = [0, 1].map(|_| Barrier(Arc::default()));
    let (done, made) = sync_channel(1);
    std::thread::spawn(move || {
        let [a, b] = [&in_loop, &in_discovery].map(Barrier::clone);
        let held = builder()
            .data_filter(move |_, _| (a.pass(), true).1)
            .participant_listener(move |_| (b.pass(), false).1);
        let (participant, sender) = (held.build().unwrap(), builder().build().unwrap());
        let (qos, kind) = (QosPolicies::default(), TopicKind::NoKey);
        let topic_of = |p: &DomainParticipant| p.create_topic("t".into(), "u8".into(), &qos, kind).unwrap();
        let [topic, same] = [&participant, &sender].map(topic_of);
        let publishers = [&participant, &sender].map(|p| p.create_publisher(&qos).unwrap());
        let subscriber = participant.create_subscriber(&qos).unwrap();
        let writer = || loop {
            match publishers[0].create_datawriter_no_key_cdr::<u8>(&topic, None) {
                Ok(writer) => break writer,
                // The queue for new writers is short.
                Err(_) => std::thread::sleep(Duration::from_millis(1)),
            }
        };
        let writers: Vec<_> = (0..WRITERS).map(|_| writer()).collect();
        let from_outside = publishers[1].create_datawriter_no_key_cdr::<u8>(&same, None).unwrap();
        let reader = || subscriber.create_datareader_no_key_cdr::<u8>(&topic, None).unwrap();
        let mut first = reader();
        while first.take_next_sample().unwrap().is_none() {
            from_outside.write(0, None).unwrap();
            std::thread::sleep(Duration::from_millis(10));
        }
        let (announced, discover) = in_discovery.arm();
        let peer = builder().build().unwrap();
        announced.recv().unwrap();
        let second = reader();
        // Time for the event loop to tell discovery of the reader.
        std::thread::sleep(Duration::from_millis(500));
        let (held, go_on) = in_loop.arm();
        from_outside.write(1, None).unwrap();
        held.recv().unwrap();
        discover.send(()).unwrap();
        // Time for discovery to fill the queue.
        std::thread::sleep(Duration::from_millis(500));
        let event_loop = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(500));
            go_on.send(()).unwrap();
        });
        let third = reader();
        event_loop.join().unwrap();
        drop((first, second, third, writers, from_outside, participant, sender, peer));
        done.send(()).unwrap();
    });
    assert!(made.recv_timeout(Duration::from_secs(20)).is_ok(), "the participant hangs");
}
