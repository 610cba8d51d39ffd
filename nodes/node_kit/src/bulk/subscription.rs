//! The reading end on a bus.

use super::limits::REST;
use super::part_topics::beside;
use super::receiver::Receiver;
use crate::bus::{Bus, SubscriptionId};
use crate::bus_error::BusError;
use crate::demand::Demand;
use crate::sample::Sample;
use crate::typed::{Publisher, Subscription};
use grainlab_msgs::msg::{PackingChunk, PackingCredit};
use grainlab_msgs::{Topic, topics};
use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

/// Parts that may wait between two looks.
const PARTS: u32 = 64;

/// While more bytes than this wait to be taken, the writers of large messages wait, too.
const ENOUGH: usize = 64 << 20;

/// Receives messages of any length of one topic, undecoded and in order, whichever way they came.
///
/// It has to be looked at every so often, or the writers take the reader for dead: [`BulkSubscription::take`] in each
/// step, and no wait beyond [`BulkSubscription::patience`].
#[derive(Debug)]
pub struct BulkSubscription {
    resolved: String,
    plain: SubscriptionId,
    parts: Subscription<PackingChunk>,
    part_topic: Topic,
    credits: Publisher<PackingCredit>,
    receiver: Receiver,
    /// What came and was not taken yet.
    queue: VecDeque<Sample>,
    depth: usize,
    /// Times of the body under way of each writer: when its first part was written.
    written: BTreeMap<crate::sample::WriterId, Option<u64>>,
    /// Writers of parts that are matched.
    writers: usize,
    next_look: Duration,
    overrun: u64,
}

impl BulkSubscription {
    /// Subscribes to `topic` with `demand`, and to its parts; at most the demand's depth of messages wait to be taken.
    pub fn subscribe(bus: &mut dyn Bus, topic: &Topic, demand: Demand) -> Result<Self, BusError> {
        let resolved = bus.resolve(topic)?;
        // A writer that sees the plain subscription sees this one, too: endpoints become known in their order.
        let part_topic = beside(&resolved, &topics::PACKING_CHUNK);
        let parts = Subscription::subscribe(bus, &part_topic, Demand::best_effort(PARTS))?;
        let credits = Publisher::advertise(bus, &beside(&resolved, &topics::PACKING_CREDIT))?;
        let plain = bus.subscribe(topic, demand)?;
        let receiver = Receiver::new(bus.now());
        Ok(Self {
            resolved,
            plain,
            parts,
            part_topic,
            credits,
            receiver,
            queue: VecDeque::new(),
            depth: demand.depth.max(1) as usize,
            written: BTreeMap::new(),
            writers: 0,
            next_look: Duration::ZERO,
            overrun: 0,
        })
    }

    /// The next message, if there is one. Never waits.
    ///
    /// A large one has the writer of its parts for a writer, and its place among that writer's large messages for a
    /// sequence number: 1, 2, 3, …, as if the parts were fragments below the bus.
    pub fn take(&mut self, bus: &mut dyn Bus) -> Result<Option<Sample>, BusError> {
        self.advance(bus)?;
        Ok(self.queue.pop_front())
    }

    /// Takes in what arrived and says what is missing. For a reader that takes nothing now.
    pub fn advance(&mut self, bus: &mut dyn Bus) -> Result<(), BusError> {
        let now = bus.now();
        // Small ones first: their writer sends one only when the large one before it is here, but a large one at once.
        while let Some(sample) = bus.take(self.plain)? {
            self.push(sample);
        }
        while let Some((part, info)) = self.parts.take_valid(bus)? {
            let heard = self.receiver.hear(now, info.writer, &part);
            if heard.begins {
                self.written.insert(info.writer, info.source_time);
            }
            if let Some(fault) = heard.fault {
                bus.count_refused(self.parts.id());
                log::warn!("{}: from writer {}: {fault}", self.resolved, info.writer);
            }
            if let Some(whole) = heard.whole {
                let source_time = self.written.remove(&info.writer).flatten().or(info.source_time);
                let info = crate::sample::SampleInfo { sequence: whole.number, source_time, ..info };
                self.push(Sample { body: whole.body, info });
            }
        }
        let writers = bus.writers(self.parts.id());
        if std::mem::replace(&mut self.writers, writers) != writers {
            self.receiver.greet(now);
        }
        let waiting: usize = self.queue.iter().map(|sample| sample.body.len()).sum();
        self.receiver.set_ready(now, waiting <= ENOUGH);
        if now >= self.next_look {
            self.next_look = now + REST;
            self.receiver.tend(now, &bus.foreign_writers(&self.part_topic));
        }
        for credit in self.receiver.credits(now) {
            match self.credits.publish(bus, &credit) {
                // It is said again.
                Ok(_) | Err(BusError::Full { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// How long a node may wait at `now` before it looks here again; what arrives ends its wait by itself.
    pub fn patience(&self, now: Duration) -> Duration {
        self.receiver.due().saturating_sub(now)
    }

    /// The resolved name of the plain topic, which is what messages are of.
    pub fn topic(&self) -> &str {
        &self.resolved
    }

    /// Messages that wait to be taken.
    pub fn waiting(&self) -> usize {
        self.queue.len()
    }

    /// Parts here and in all of a large message under way, if one is.
    pub fn under_way(&self) -> Option<(u64, u32)> {
        self.receiver.under_way()
    }

    /// The plain topic's handle, for [`Bus::writers`] and [`Bus::count_refused`].
    pub fn id(&self) -> SubscriptionId {
        self.plain
    }

    /// Keep last: the oldest gives way.
    fn push(&mut self, sample: Sample) {
        if self.queue.len() >= self.depth {
            self.queue.pop_front();
            self.overrun += 1;
            if self.overrun.is_power_of_two() {
                log::warn!("{}: {} messages came too fast and were dropped", self.resolved, self.overrun);
            }
        }
        self.queue.push_back(sample);
    }
}
