//! Samples of any topic, those of packings whole.

use crate::bulk::BulkSubscription;
use crate::bus::Bus;
use crate::bus_error::BusError;
use crate::demand::Demand;
use crate::handles::SubscriptionId;
use crate::sample::Sample;
use grainlab_msgs::{Topic, topics};
use std::time::Duration;

/// A subscription to a topic of any type, undecoded.
#[derive(Debug)]
pub enum Source {
    /// Messages of one sample.
    Samples(SubscriptionId),
    /// Packings, which may come in parts.
    Packings(Box<BulkSubscription>),
}

impl Source {
    /// Subscribes.
    ///
    /// # Errors
    /// If the topic is refused.
    pub fn open(bus: &mut dyn Bus, topic: &Topic, demand: Demand) -> Result<Self, BusError> {
        Ok(match topic.info == topics::PACKING.info {
            true => Self::Packings(Box::new(BulkSubscription::subscribe(bus, topic, demand)?)),
            false => Self::Samples(bus.subscribe(topic, demand)?),
        })
    }

    /// The next sample, if there is one. Never waits.
    ///
    /// # Errors
    /// If the bus fails.
    pub fn take(&mut self, bus: &mut dyn Bus) -> Result<Option<Sample>, BusError> {
        match self {
            Self::Samples(id) => bus.take(*id),
            Self::Packings(packings) => packings.take(bus),
        }
    }

    /// The subscription to the topic itself.
    pub fn id(&self) -> SubscriptionId {
        match self {
            Self::Samples(id) => *id,
            Self::Packings(packings) => packings.id(),
        }
    }

    /// Longest wait from `now` until the next call of [`Source::take`].
    pub fn patience(&self, now: Duration) -> Duration {
        match self {
            Self::Samples(_) => Duration::MAX,
            Self::Packings(packings) => packings.patience(now),
        }
    }
}
