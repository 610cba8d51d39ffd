//! Reception of the samples of a topic.

use grainlab_msgs::{Qos, Topic, topics};
use grainlab_node_kit::{BulkSubscription, Bus, BusError, Demand, Sample, SubscriptionId};
use std::time::Duration;

/// Samples queued between two steps of the node.
const BACKLOG: u32 = 1_000;

/// Packings queued between two steps, megabytes each.
const PACKINGS: u32 = 8;

/// Samples, or packings, which may come in parts.
#[derive(Debug)]
pub(crate) enum Source {
    Samples(SubscriptionId),
    Packings(Box<BulkSubscription>),
}

impl Source {
    /// Subscribes. A topic that keeps samples for late readers is read reliably, because only such a reader gets them; any
    /// other one without repetition, so that its writer never waits for a viewer.
    pub(crate) fn open(bus: &mut dyn Bus, topic: &Topic) -> Result<Self, BusError> {
        let latched = topic.qos.transient_local && topic.qos.reliable;
        let qos = Qos { reliable: latched, transient_local: latched, ..topic.qos };
        let topic = Topic { qos, ..*topic };
        let demand = |depth| if latched { Demand::reliable(depth) } else { Demand::best_effort(depth) };
        Ok(if topic.info == topics::PACKING.info {
            Self::Packings(Box::new(BulkSubscription::subscribe(bus, &topic, demand(PACKINGS))?))
        } else {
            Self::Samples(bus.subscribe(&topic, demand(BACKLOG))?)
        })
    }

    /// The next sample, if any.
    pub(crate) fn take(&mut self, bus: &mut dyn Bus) -> Result<Option<Sample>, BusError> {
        match self {
            Self::Samples(id) => bus.take(*id),
            Self::Packings(packings) => packings.take(bus),
        }
    }

    /// Longest wait until the next call of [`Source::take`].
    pub(crate) fn patience(&self, now: Duration) -> Duration {
        match self {
            Self::Samples(_) => Duration::MAX,
            Self::Packings(packings) => packings.patience(now),
        }
    }

    /// Ends the subscription.
    pub(crate) fn close(self, bus: &mut dyn Bus) {
        match self {
            Self::Samples(id) => bus.unsubscribe(id),
            Self::Packings(packings) => packings.close(bus),
        }
    }
}
