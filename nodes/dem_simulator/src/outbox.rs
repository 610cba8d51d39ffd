//! Messages in their order, none lost where a reader is behind.

use node_kit::{BulkPublisher, Bus, BusError, PublisherId};
use std::collections::VecDeque;

/// Packings that may wait behind the one that is under way before the run waits for the readers: megabytes each.
const PACKINGS_AHEAD: usize = 2;

#[derive(Debug)]
enum Item {
    /// A request: the lockstep goes on while a packing is under way.
    Request(PublisherId, Vec<u8>),
    /// Where the run stands: not before the packings that it speaks of are delivered.
    State(PublisherId, Vec<u8>),
    /// A packing of any length.
    Packing(Vec<u8>),
}

/// What is still to be published, in order. A large packing takes its time; requests pass it, everything else waits.
#[derive(Debug)]
pub(crate) struct Outbox {
    packings: BulkPublisher,
    waiting: VecDeque<Item>,
    /// States and packings behind the packing that is under way.
    behind: VecDeque<Item>,
    under_way: bool,
    held_up: u64,
}

impl Outbox {
    pub(crate) fn new(packings: BulkPublisher) -> Self {
        let (waiting, behind) = (VecDeque::new(), VecDeque::new());
        Self { packings, waiting, behind, under_way: false, held_up: 0 }
    }

    /// The publisher of packings.
    pub(crate) fn packings(&self) -> &BulkPublisher {
        &self.packings
    }

    pub(crate) fn post_request(&mut self, publisher: PublisherId, body: Vec<u8>) {
        self.waiting.push_back(Item::Request(publisher, body));
    }

    pub(crate) fn post_state(&mut self, publisher: PublisherId, body: Vec<u8>) {
        self.waiting.push_back(Item::State(publisher, body));
    }

    pub(crate) fn post_packing(&mut self, body: Vec<u8>) {
        self.waiting.push_back(Item::Packing(body));
    }

    /// Publishes what the bus takes and moves a large packing on; true if the run may go on. A reliable reader that is too
    /// far behind holds the rest up: the run waits for it rather than lose a sample.
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
        Ok(self.behind.iter().filter(|item| matches!(item, Item::Packing(_))).count() < PACKINGS_AHEAD)
    }

    /// The item comes back if it cannot be sent now.
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
                    // A large one takes its time from now on.
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

    /// Whether everything was delivered to every reader that lives.
    pub(crate) fn is_empty(&self) -> bool {
        !self.under_way && self.behind.is_empty() && self.waiting.is_empty()
    }

    /// Whether a packing is under way, so that [`Outbox::deliver`] has to be called again soon.
    pub(crate) fn is_under_way(&self) -> bool {
        self.under_way || !self.behind.is_empty()
    }

    /// There is no more time: sends what still waits, packings that are under way or not. How many readers lack something.
    pub(crate) fn hurry(&mut self, bus: &mut dyn Bus) -> Result<usize, BusError> {
        let lacking = self.packings.waited_for();
        self.under_way = false;
        for item in self.behind.drain(..).chain(self.waiting.drain(..)) {
            let sent = match &item {
                Item::Request(publisher, body) | Item::State(publisher, body) => {
                    bus.publish(*publisher, body).map(|_| ())
                }
                Item::Packing(body) => self.packings.publish(bus, body),
            };
            match sent {
                Ok(()) | Err(BusError::Full { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(lacking)
    }

    /// How often a reader held the run up.
    pub(crate) fn held_up(&self) -> u64 {
        self.held_up
    }
}
