//! Messages in order, none lost if a reader is behind.

use grainlab_node_kit::{BulkPublisher, Bus, BusError, PublisherId};
use std::collections::VecDeque;
use std::time::Duration;

/// Number of packings, of megabytes each, that may be queued behind the one in transit before the run waits for the
/// readers.
const QUEUED_PACKINGS: usize = 2;

/// Duration of an exchange from which a packing in transit goes first.
const SLOW: Duration = Duration::from_millis(20);

/// Longest time for which a reader that takes no part of a packing delays an exchange.
const SLOW_READER: Duration = Duration::from_millis(250);

#[derive(Debug)]
enum Item {
    /// A request: it may overtake a packing in transit.
    Request(PublisherId, Vec<u8>),
    /// A run state: it follows the packings that it counts.
    State(PublisherId, Vec<u8>),
    /// A packing of any length.
    Packing(Vec<u8>),
}

/// Messages to publish, in order. Requests overtake a large packing in transit; all other messages wait for it.
#[derive(Debug)]
pub(crate) struct SendQueue {
    pub(crate) packings: BulkPublisher,
    waiting: VecDeque<Item>,
    /// States and packings behind the packing in transit.
    behind: VecDeque<Item>,
    under_way: bool,
    /// Number of times that a slow reader delayed the run.
    pub(crate) held_up: u64,
}

impl SendQueue {
    pub(crate) fn new(packings: BulkPublisher) -> Self {
        let (waiting, behind) = (VecDeque::new(), VecDeque::new());
        Self { packings, waiting, behind, under_way: false, held_up: 0 }
    }

    pub(crate) fn push_request(&mut self, publisher: PublisherId, body: Vec<u8>) {
        self.waiting.push_back(Item::Request(publisher, body));
    }

    pub(crate) fn push_state(&mut self, publisher: PublisherId, body: Vec<u8>) {
        self.waiting.push_back(Item::State(publisher, body));
    }

    pub(crate) fn push_packing(&mut self, body: Vec<u8>) {
        self.waiting.push_back(Item::Packing(body));
    }

    /// Publishes what the bus accepts and sends parts of a large packing; true if the run may continue. If a reliable
    /// reader is too far behind, the run waits for it instead of losing a sample.
    pub(crate) fn deliver(&mut self, bus: &mut dyn Bus) -> Result<bool, BusError> {
        self.under_way = !self.packings.advance(bus)?;
        while let Some(item) = self.behind.pop_front() {
            if let Some(item) = self.send(bus, item)? {
                self.behind.push_front(item);
                break;
            }
        }
        while let Some(item) = self.waiting.pop_front() {
            let passes = matches!(item, Item::Request(..));
            if !passes && (self.under_way || !self.behind.is_empty()) {
                self.behind.push_back(item);
            } else if let Some(item) = self.send(bus, item)? {
                self.waiting.push_front(item);
                return Ok(false);
            }
        }
        Ok(self.behind.iter().filter(|item| matches!(item, Item::Packing(_))).count() < QUEUED_PACKINGS)
    }

    /// Sends an item; returns it if it cannot be sent now.
    fn send(&mut self, bus: &mut dyn Bus, item: Item) -> Result<Option<Item>, BusError> {
        let sent = match &item {
            Item::Request(publisher, body) => bus.publish(*publisher, body).map(|_| ()),
            _ if self.under_way => return Ok(Some(item)),
            Item::State(publisher, body) => bus.publish(*publisher, body).map(|_| ()),
            Item::Packing(body) => self.packings.publish(bus, body),
        };
        match sent {
            Ok(()) => {
                if matches!(item, Item::Packing(_)) {
                    // A large packing is in transit from now on.
                    self.under_way = !self.packings.advance(bus)?;
                }
                Ok(None)
            }
            Err(full @ BusError::Full { .. }) => {
                self.held_up += 1;
                if self.held_up.is_power_of_two() {
                    log::warn!("the run waits ({} times so far): {full}", self.held_up);
                }
                Ok(Some(item))
            }
            Err(error) => Err(error),
        }
    }

    /// True if all messages were delivered to all active readers.
    pub(crate) fn is_empty(&self) -> bool {
        !self.under_way && self.behind.is_empty() && self.waiting.is_empty()
    }

    /// True if a packing is in transit, so that [`SendQueue::deliver`] must be called again soon.
    pub(crate) fn is_under_way(&self) -> bool {
        self.under_way || !self.behind.is_empty()
    }

    /// True while readers take parts of a large packing and the next exchange would take long, as the last advance did (its duration
    /// and its end): parts pass between exchanges alone, and a million grains have thousands of them. Readers that take none
    /// delay an exchange by an eighth of its time.
    pub(crate) fn goes_first(&self, now: Duration, (took, ended): (Duration, Duration)) -> bool {
        let last = self.packings.last_progress().filter(|_| self.under_way && took > SLOW);
        last.is_some_and(|last| now.saturating_sub(last.max(ended)) < (took / 8).min(SLOW_READER))
    }

    /// Sends all queued messages now, for a process that is about to end: the last packing replaces one in transit.
    pub(crate) fn flush(&mut self, bus: &mut dyn Bus) -> Result<(), BusError> {
        self.packings.hurry();
        for item in self.behind.drain(..).chain(self.waiting.drain(..)) {
            let sent = match &item {
                Item::Request(publisher, body) | Item::State(publisher, body) => {
                    bus.publish(*publisher, body).map(|_| ())
                }
                Item::Packing(body) => self.packings.supersede(bus, body),
            };
            match sent {
                Ok(()) => {}
                Err(full @ BusError::Full { .. }) => log::warn!("{full}"),
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_msgs::topics;
    use grainlab_node_kit::BULK_LIMIT;
    use grainlab_node_kit::{BulkSubscription, Demand, Hub, MemoryBus, Names, SubscriptionId};

    /// A simulator's bus with its queue, and a reader of everything.
    struct Bench {
        hub: Hub,
        bus: MemoryBus,
        queue: SendQueue,
        stress: PublisherId,
        run_state: PublisherId,
        reader: MemoryBus,
        packings: BulkSubscription,
        requests: SubscriptionId,
        states: SubscriptionId,
        /// The first letter of each message's topic, and its number.
        received: Vec<String>,
    }

    fn body(number: u8, length: usize) -> Vec<u8> {
        let mut body = vec![number; length];
        body[..4].copy_from_slice(&[0, 1, 0, 0]);
        body
    }

    impl Bench {
        fn new() -> Self {
            let hub = Hub::new(1);
            let mut reader = hub.bus(Names::new("reader").unwrap());
            let demand = Demand::reliable(100);
            let packings = BulkSubscription::subscribe(&mut reader, &topics::PACKING, demand).unwrap();
            let requests = reader.subscribe(&topics::STRESS, demand).unwrap();
            let states = reader.subscribe(&topics::RUN_STATE, demand).unwrap();
            let mut bus = hub.bus(Names::new("dem_simulator").unwrap());
            let stress = bus.advertise(&topics::STRESS).unwrap();
            let queue = SendQueue::new(BulkPublisher::advertise(&mut bus, &topics::PACKING).unwrap());
            let run_state = bus.advertise(&topics::RUN_STATE).unwrap();
            let received = Vec::new();
            Self { hub, bus, queue, stress, run_state, reader, packings, requests, states, received }
        }

        /// The reader receives, and a millisecond passes.
        fn look(&mut self) {
            for (letter, subscription) in [("r", self.requests), ("s", self.states)] {
                while let Some(sample) = self.reader.take(subscription).unwrap() {
                    self.received.push(format!("{letter}{}", sample.body[4]));
                }
            }
            while let Some(sample) = self.packings.take(&mut self.reader).unwrap() {
                self.received.push(format!("p{}", sample.body[4]));
            }
            self.hub.advance(Duration::from_millis(1));
        }

        fn deliver(&mut self) -> bool {
            self.queue.deliver(&mut self.bus).unwrap()
        }

        fn until_empty(&mut self) {
            for _ in 0..20_000 {
                self.deliver();
                if self.queue.is_empty() {
                    return self.look();
                }
                self.look();
            }
            panic!("not delivered within 20 s");
        }
    }

    #[test]
    fn requests_overtake_a_large_packing_and_its_state_does_not() {
        let mut bench = Bench::new();
        let (stress, run_state) = (bench.stress, bench.run_state);
        bench.queue.push_packing(body(1, 3 * BULK_LIMIT));
        bench.queue.push_state(run_state, body(2, 8));
        bench.queue.push_packing(body(3, 100));
        bench.queue.push_request(stress, body(4, 8));
        assert!(bench.deliver(), "the run goes on");
        bench.look();
        assert_eq!(bench.received, ["r4"]);
        assert!(bench.queue.is_under_way() && !bench.queue.is_empty());
        bench.until_empty();
        assert_eq!(bench.received, ["r4", "p1", "s2", "p3"]);
    }

    #[test]
    fn a_packing_in_transit_goes_before_a_slow_exchange_while_readers_take_it() {
        let mut bench = Bench::new();
        bench.look();
        bench.queue.push_packing(body(1, 30 * BULK_LIMIT));
        bench.deliver();
        let (slow, fast) = (Duration::from_secs(4), Duration::from_millis(1));
        let began = bench.hub.now();
        let mut parts = 0;
        while bench.queue.goes_first(bench.hub.now(), (slow, began)) {
            assert!(!bench.queue.goes_first(bench.hub.now(), (fast, began)), "a fast exchange does not wait");
            bench.deliver();
            bench.look();
            parts += 1;
        }
        assert!(!bench.queue.is_under_way(), "after {parts} looks");
        assert_eq!(bench.received, ["p1"]);
        // A reader that is busy.
        bench.queue.push_packing(body(2, 30 * BULK_LIMIT));
        bench.deliver();
        bench.look();
        let began = bench.hub.now();
        while bench.queue.goes_first(bench.hub.now(), (slow, began)) {
            bench.deliver();
            bench.hub.advance(Duration::from_millis(1));
        }
        let waited = bench.hub.now() - began;
        assert!(bench.queue.is_under_way() && waited < Duration::from_millis(500), "{waited:?}");
    }

    #[test]
    fn small_messages_are_published_at_once_in_the_order_in_which_they_were_posted() {
        let mut bench = Bench::new();
        let (stress, run_state) = (bench.stress, bench.run_state);
        bench.queue.push_packing(body(1, 100));
        bench.queue.push_state(run_state, body(2, 8));
        bench.queue.push_request(stress, body(3, 8));
        assert!(bench.deliver() && bench.queue.is_empty());
        bench.look();
        bench.received.sort();
        assert_eq!(bench.received, ["p1", "r3", "s2"]);
    }

    #[test]
    fn a_run_that_makes_packings_faster_than_they_are_read_waits() {
        let mut bench = Bench::new();
        let mut posted = 0;
        for _ in 0..100 {
            if bench.deliver() {
                posted += 1;
                bench.queue.push_packing(body(posted, BULK_LIMIT + 1));
            }
        }
        assert_eq!(posted, 3, "one under way, two behind it");
        bench.until_empty();
        assert_eq!(bench.received, ["p1", "p2", "p3"]);
    }

    #[test]
    fn a_killed_reader_delays_the_end_of_a_run_by_the_time_limit_for_silent_readers_at_most() {
        let mut bench = Bench::new();
        (0..100).for_each(|_| bench.look());
        let run_state = bench.run_state;
        bench.queue.push_packing(body(1, 3 * BULK_LIMIT));
        bench.queue.push_state(run_state, body(2, 8));
        let began = bench.hub.now();
        while !bench.queue.is_empty() {
            bench.deliver();
            bench.hub.advance(Duration::from_millis(5));
            assert!(bench.hub.now() - began < Duration::from_secs(20));
        }
        assert_eq!(bench.queue.packings.left_behind(), 1);
        // Without time left, queued messages are sent all the same.
        bench.queue.push_packing(body(3, 3 * BULK_LIMIT));
        bench.queue.push_state(run_state, body(4, 8));
        bench.queue.push_packing(body(5, 3 * BULK_LIMIT));
        bench.deliver();
        bench.queue.flush(&mut bench.bus).unwrap();
        // The reader was only paused.
        for _ in 0..500 {
            bench.deliver();
            bench.look();
        }
        assert_eq!(bench.received.iter().rfind(|message| message.starts_with('p')).unwrap(), "p5");
        assert!(bench.received.contains(&"s4".into()), "{:?}", bench.received);
    }
}
