//! The receiver on a bus.

use super::limits::IDLE_CREDIT_PERIOD;
use super::part_topics::beside;
use super::receiver::Receiver;
use crate::bus::Bus;
use crate::bus_error::{BusError, tolerate_full};
use crate::demand::Demand;
use crate::handles::SubscriptionId;
use crate::sample::{Sample, SampleInfo};
use crate::typed::{Publisher, Subscription};
use grainlab_msgs::msg::{PackingChunk, PackingCredit};
use grainlab_msgs::{Topic, topics};
use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

/// Maximum number of parts queued between two calls.
const PARTS: u32 = 64;

/// While more bytes than this are queued, the reader accepts no further large message.
const ENOUGH: usize = 64 << 20;

/// Receives messages of any length on one topic, undecoded and in order, whether sent as one sample or in parts.
///
/// A node calls [`BulkSubscription::take`] in each step and waits no longer than [`BulkSubscription::patience`];
/// otherwise the writers stop waiting for this reader.
#[derive(Debug)]
pub struct BulkSubscription {
    resolved: String,
    plain: SubscriptionId,
    plain_topic: Topic,
    parts: Subscription<PackingChunk>,
    part_topic: Topic,
    credits: Publisher<PackingCredit>,
    receiver: Receiver,
    queue: VecDeque<Sample>,
    depth: usize,
    /// For each writer, the source time of the first part of the body in transit.
    written: BTreeMap<grainlab_msgs::Guid, Option<u64>>,
    /// Number of matched writers of parts.
    writers: usize,
    next_look: Duration,
    overrun: u64,
}

impl BulkSubscription {
    /// Subscribes to `topic` with `demand`, and to its parts. The queue holds at most `demand.depth` messages.
    pub fn subscribe(bus: &mut dyn Bus, topic: &Topic, demand: Demand) -> Result<Self, BusError> {
        let resolved = bus.resolve(topic)?;
        // Endpoints are discovered in this order, so a writer that sees the plain subscription sees this one, too.
        let part_topic = beside(&resolved, &topics::PACKING_CHUNK);
        let parts = Subscription::subscribe(bus, &part_topic, Demand::best_effort(PARTS))?;
        let credits = Publisher::advertise(bus, &beside(&resolved, &topics::PACKING_CREDIT))?;
        let plain = bus.subscribe(topic, demand)?;
        let receiver = Receiver::new(bus.now());
        Ok(Self {
            resolved,
            plain,
            plain_topic: *topic,
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
    /// The writer of a large message is the writer of its parts; its sequence number counts that writer's large
    /// messages from 1.
    pub fn take(&mut self, bus: &mut dyn Bus) -> Result<Option<Sample>, BusError> {
        self.advance(bus)?;
        Ok(self.queue.pop_front())
    }

    /// Processes what arrived and sends the credits that are due, without taking a message.
    pub fn advance(&mut self, bus: &mut dyn Bus) -> Result<(), BusError> {
        let now = bus.now();
        // Small messages first: a writer sends one only after the large one before it was received, but a large one
        // after a small one at once.
        while let Some(sample) = bus.take(self.plain)? {
            self.push(sample);
        }
        while let Some((part, info)) = self.parts.take_valid(bus)? {
            // The parts have no type: that of the whole is announced by the plain writer.
            if bus.misfits(&self.plain_topic).contains(&info.writer.participant()) {
                bus.count_refused(self.parts.id());
                continue;
            }
            let outcome = self.receiver.receive(now, info.writer, &part);
            if outcome.begins {
                self.written.insert(info.writer, info.source_time);
            }
            if let Some(fault) = outcome.fault {
                bus.count_refused(self.parts.id());
                log::warn!("{}: from writer {}: {fault}", self.resolved, info.writer);
            }
            if let Some((sequence, body)) = outcome.whole {
                let source_time = self.written.remove(&info.writer).flatten().or(info.source_time);
                self.push(Sample { body, info: SampleInfo { sequence, source_time, ..info } });
            }
        }
        let writers = bus.writers(self.parts.id());
        if std::mem::replace(&mut self.writers, writers) != writers {
            self.receiver.send_credits_now(now);
        }
        let waiting: usize = self.queue.iter().map(|sample| sample.body.len()).sum();
        self.receiver.set_ready(now, waiting <= ENOUGH);
        if now >= self.next_look {
            self.next_look = now + IDLE_CREDIT_PERIOD;
            self.receiver.forget_absent(now, &bus.foreign_writers(&self.part_topic));
        }
        for credit in self.receiver.credits(now) {
            // A refused credit is repeated later.
            tolerate_full(self.credits.publish(bus, &credit))?;
        }
        Ok(())
    }

    /// Longest wait from `now` until the next call; an arriving message ends the wait.
    pub fn patience(&self, now: Duration) -> Duration {
        self.receiver.due().saturating_sub(now)
    }

    /// The resolved name of the plain topic.
    pub fn topic(&self) -> &str {
        &self.resolved
    }

    /// Number of queued messages.
    pub fn waiting(&self) -> usize {
        self.queue.len()
    }

    /// The plain topic's handle, for [`Graph::writers`](crate::Graph::writers) and [`Statistics::count_refused`](crate::Statistics::count_refused).
    pub fn id(&self) -> SubscriptionId {
        self.plain
    }

    /// Queues a message; a full queue drops its oldest one.
    fn push(&mut self, sample: Sample) {
        if self.queue.len() >= self.depth {
            self.queue.pop_front();
            self.overrun += 1;
            if self.overrun.is_power_of_two() {
                log::warn!("{}: {} messages arrived too fast and were dropped", self.resolved, self.overrun);
            }
        }
        self.queue.push_back(sample);
    }
}
