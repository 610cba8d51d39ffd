//! The sender on a bus.

use super::limits::{POLL_PERIOD, WINDOW};
use super::part_topics::beside;
use super::sender::Sender;
use crate::bus::Bus;
use crate::bus_error::BusError;
use crate::demand::Demand;
use crate::handles::PublisherId;
use crate::typed::{Publisher, Subscription};
use grainlab_msgs::msg::{PackingChunk, PackingCredit};
use grainlab_msgs::{Guid, Topic, topics};
use std::time::Duration;

/// Credits queued while a node computes: only the latest of each reader matters.
const CREDITS: u32 = 256;

/// Parts handed to the bus per call: more would block the caller.
const AT_ONCE: u32 = WINDOW;

/// Publishes messages of any length on one topic, in order: small ones as they are, large ones in parts.
///
/// [`BulkPublisher::advance`] sends the parts; a node calls it in each step until it returns true.
#[derive(Debug)]
pub struct BulkPublisher {
    topic: Topic,
    resolved: String,
    plain: PublisherId,
    parts: Publisher<PackingChunk>,
    credits: Subscription<PackingCredit>,
    credit_topic: Topic,
    sender: Sender,
    present: Vec<Guid>,
    next_look: Duration,
    left_behind: u64,
}

impl BulkPublisher {
    /// Advertises `topic` and the topic of its parts, and subscribes to the credits.
    pub fn advertise(bus: &mut dyn Bus, topic: &Topic) -> Result<Self, BusError> {
        let resolved = bus.resolve(topic)?;
        let plain = bus.advertise(topic)?;
        let parts = Publisher::advertise(bus, &beside(&resolved, &topics::PACKING_CHUNK))?;
        let own = bus.published().last().map(|p| p.writer).unwrap_or_default();
        let credit_topic = beside(&resolved, &topics::PACKING_CREDIT);
        let credits = Subscription::subscribe(bus, &credit_topic, Demand::best_effort(CREDITS))?;
        Ok(Self {
            topic: *topic,
            resolved,
            plain,
            parts,
            credits,
            credit_topic,
            sender: Sender::new(own),
            present: Vec::new(),
            next_look: Duration::ZERO,
            left_behind: 0,
        })
    }

    /// The plain topic's handle, for [`Graph::readers`](crate::Graph::readers).
    pub fn id(&self) -> PublisherId {
        self.plain
    }

    /// Number of times that a reader was not waited for any longer.
    pub fn left_behind(&self) -> u64 {
        self.left_behind
    }

    /// Publishes one serialized message, encapsulation included.
    ///
    /// # Errors
    /// [`BusError::Full`] while the previous message is in transit: the caller keeps the message and tries again.
    pub fn publish(&mut self, bus: &mut dyn Bus, body: &[u8]) -> Result<(), BusError> {
        if !self.advance(bus)? {
            return Err(BusError::Full { topic: self.resolved.clone(), window: WINDOW });
        }
        self.supersede(bus, body)
    }

    /// Waits only for a short time, from now on, for readers that are silent or not ready: the process is about to end.
    pub fn hurry(&mut self) {
        self.sender.hurry();
    }

    /// Publishes without waiting for readers that lack the previous message: they never receive it. For the last message
    /// of a process.
    pub fn supersede(&mut self, bus: &mut dyn Bus, body: &[u8]) -> Result<(), BusError> {
        if body.len() <= bus.longest_sample() {
            bus.publish(self.plain, body)?;
            self.sender.retire();
            return Ok(());
        }
        bus.count_published(self.parts.id(), &self.topic)?;
        self.sender.offer(bus.now(), body.to_vec());
        self.next_look = Duration::ZERO;
        self.advance(bus).map(|_| ())
    }

    /// Receives credits and sends parts. Returns true if nothing is in transit to any reader. Never waits.
    pub fn advance(&mut self, bus: &mut dyn Bus) -> Result<bool, BusError> {
        while let Some((credit, info)) = self.credits.take_valid(bus)? {
            let (now, wall) = (bus.now(), bus.wall_nanos());
            // The credit may have been queued while the node computed.
            let age = Duration::from_nanos(wall.saturating_sub(info.received));
            self.sender.receive(now.saturating_sub(age), info.writer, info.sequence, &credit);
        }
        if self.sender.is_idle() {
            return Ok(true);
        }
        let now = bus.now();
        if now >= self.next_look {
            self.next_look = now + POLL_PERIOD;
            self.present = bus.foreign_writers(&self.credit_topic);
            for (reader, reason) in self.sender.apply_time_limits(now, &self.present) {
                self.left_behind += 1;
                log::warn!(
                    "{}: not waiting any longer for the reader with credits of writer {reader}: {reason}",
                    self.resolved
                );
            }
        }
        for _ in 0..AT_ONCE {
            let Some(part) = self.sender.next_part(now) else { break };
            match self.parts.publish(bus, &part) {
                Ok(_) => {}
                Err(BusError::Full { .. }) => {
                    self.sender.put_back(part.index);
                    break;
                }
                Err(error) => return Err(error),
            }
        }
        let matched = bus.readers(self.parts.id());
        Ok(!self.sender.is_busy(now, &self.present, matched))
    }

    /// Longest wait between two calls of [`BulkPublisher::advance`] while something is in transit; a credit ends the
    /// wait.
    pub const fn patience() -> Duration {
        POLL_PERIOD
    }

    /// Last time at which an active reader that lacks parts of the latest message took one; `None` without such a reader.
    pub fn last_progress(&self) -> Option<Duration> {
        self.sender.last_progress()
    }

    /// Number of active readers that lack parts of the latest message.
    pub fn waited_for(&self) -> usize {
        self.sender.waited_for()
    }
}
