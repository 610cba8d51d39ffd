//! The end of processes, as observed by their peers.

use super::{Role, TIME_LIMIT, claim};
use grainlab_msgs::msg::StrainRate;
use grainlab_msgs::{Guid, topics};
use grainlab_node_kit::{
    Bus, BusError, DdsBus, Demand, Exit, Graph, Liveliness, Names, Network, PeerWatch, Report, Statistics,
};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Observes a child like the launcher and the recorder.
struct Observer {
    bus: DdsBus,
    watch: PeerWatch,
    subscriptions: Vec<grainlab_node_kit::SubscriptionId>,
    /// Highest sequence number and count of samples of each writer.
    seen: BTreeMap<Guid, (i64, u64)>,
    last: Option<Report>,
}

impl Observer {
    fn open(network: Network) -> Self {
        let mut bus = DdsBus::open(network, Names::new("observer").unwrap()).unwrap();
        let all = [topics::RUN_STATE, topics::ROSOUT, topics::DIAGNOSTICS];
        let subscriptions = all.iter().map(|t| bus.subscribe(t, Demand::reliable(2000)).unwrap()).collect();
        let watch = PeerWatch::subscribe(&mut bus).unwrap();
        Self { bus, watch, subscriptions, seen: BTreeMap::new(), last: None }
    }

    fn look(&mut self) {
        self.bus.wait(Duration::from_millis(20));
        for subscription in &self.subscriptions {
            while let Some(sample) = self.bus.take(*subscription).unwrap() {
                let entry = self.seen.entry(sample.info.writer).or_default();
                entry.0 = entry.0.max(sample.info.sequence);
                entry.1 += 1;
            }
        }
        let last = &mut self.last;
        self.watch.update(&mut self.bus, |_, report| *last = Some(report.clone())).unwrap();
    }

    fn until(&mut self, what: &str, mut done: impl FnMut(&Self) -> bool) {
        let start = Instant::now();
        while !done(self) {
            assert!(start.elapsed() < TIME_LIMIT, "not within {TIME_LIMIT:?}: {what}");
            self.look();
        }
    }

    fn until_third_report(&mut self) {
        let beats = |o: &Self| {
            o.last
                .as_ref()
                .is_some_and(|r| r.published.iter().any(|p| p.topic == "/diagnostics" && p.count >= 3))
        };
        self.until("three heartbeats", beats);
    }
}

#[test]
fn a_signal_ends_a_node_cleanly_and_its_final_counts_balance_what_was_received() {
    for (role, signal, exit) in
        [("talker", libc::SIGINT, Exit::Done), ("incomplete_talker", libc::SIGTERM, Exit::Interrupted)]
    {
        let claimed = claim();
        let network = claimed.network();
        let mut observer = Observer::open(network);
        let child = Role::start(role, network);
        observer.until_third_report();
        child.signal(signal);
        observer.until("the final report", |o| o.last.as_ref().is_some_and(Report::is_final));
        let (code, _, stderr) = child.end();
        assert_eq!(code, Some(i32::from(exit.code())), "{stderr}");
        assert!(stderr.contains(&format!("[{role}]: stopping on request")), "{stderr}");

        observer.until("the leave", |o| o.bus.foreign_writers(&topics::RUN_STATE).is_empty());
        let last = observer.last.clone().unwrap();
        assert_eq!(last.exit, Some(exit));
        assert_eq!(last.published.len(), 3, "run_state, diagnostics, rosout");
        for writer in &last.published {
            let (highest, count) = observer.seen[&writer.writer];
            assert_eq!((highest as u64, count), (writer.count, writer.count), "{}", writer.topic);
        }
        let peer = observer.watch.find(&format!("/{role}")).unwrap();
        assert_eq!(peer.liveliness(observer.bus.now()), Liveliness::Left(exit));
    }
}

#[test]
fn a_second_signal_ends_the_process_at_once() {
    let claimed = claim();
    let network = claimed.network();
    let mut observer = Observer::open(network);
    let child = Role::start("slow_talker", network);
    observer.until_third_report();
    child.signal(libc::SIGINT);
    std::thread::sleep(Duration::from_millis(500));
    let second = Instant::now();
    child.signal(libc::SIGINT);
    let (code, _, _) = child.end();
    assert_eq!(code, Some(130));
    assert!(second.elapsed() < Duration::from_secs(10), "the farewell would have taken 60 s");
}

#[test]
fn an_ended_dds_thread_ends_the_process() {
    let claimed = claim();
    let child = Role::start("talker_without_dds_thread", claimed.network());
    let (code, _, stderr) = child.end();
    assert_eq!(code, Some(1), "{stderr}");
    assert!(stderr.contains("1 of 2 DDS threads"), "{stderr}");
}

#[test]
fn a_panic_is_a_failure_that_peers_are_informed_of() {
    let claimed = claim();
    let network = claimed.network();
    let child = Role::start("panicking_node", network);
    let (code, _, stderr) = child.end();
    assert_eq!(code, Some(1), "{stderr}");
    assert!(stderr.contains("the bug") && stderr.contains("panicked (see above)"), "{stderr}");
}

#[test]
fn a_killed_process_falls_silent_while_dds_still_shows_it() {
    let claimed = claim();
    let network = claimed.network();
    let mut observer = Observer::open(network);
    let child = Role::start("talker", network);
    observer.until_third_report();
    child.signal(libc::SIGKILL);
    child.end();
    let life = |o: &Observer| o.watch.find("/talker").map(|p| p.liveliness(o.bus.now()));
    observer.until("silence", |o| matches!(life(o), Some(Liveliness::Silent(_))));
    assert_eq!(observer.bus.foreign_writers(&topics::RUN_STATE).len(), 1, "its lease has not ended yet");
}

#[test]
fn a_killed_reliable_reader_delays_a_writer_but_never_stops_it() {
    let claimed = claim();
    let network = claimed.network();
    let mut bus = DdsBus::open(network, Names::new("writer").unwrap()).unwrap();
    let publisher = bus.advertise(&topics::STRAIN_RATE).unwrap();
    let body = grainlab_msgs::to_cdr(&StrainRate::default());
    let reader = Role::start("our_listener", network);
    let start = Instant::now();
    while bus.readers(publisher) == 0 {
        assert!(start.elapsed() < TIME_LIMIT);
        bus.wait(Duration::from_millis(20));
    }
    bus.publish(publisher, &body).unwrap();
    reader.signal(libc::SIGKILL);
    reader.end();

    let mut accepted = 0;
    let refusal = loop {
        let start = Instant::now();
        match bus.publish(publisher, &body) {
            Ok(_) => accepted += 1,
            Err(error) => break (error, start.elapsed()),
        }
        assert!(accepted < 20_000, "the window never filled");
    };
    assert!(matches!(refusal.0, BusError::Full { .. }), "{}", refusal.0);
    // The bounded wait is 20 ms; scheduling on a loaded machine may add to it.
    assert!(refusal.1 >= Duration::from_millis(20) && refusal.1 < Duration::from_secs(2), "{:?}", refusal.1);
    assert!(accepted > 8000, "the window is 8192: {accepted}");
    assert_eq!(bus.published()[0].full, 1);
}
