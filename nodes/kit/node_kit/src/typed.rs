//! Typed handles over the raw bus.

use crate::bus::Bus;
use crate::bus_error::BusError;
use crate::demand::Demand;
use crate::handles::{PublisherId, SubscriptionId};
use crate::sample::{SampleId, SampleInfo};
use grainlab_msgs::{Message, Topic, from_cdr, to_cdr};
use std::marker::PhantomData;
use std::sync::atomic::{AtomicU64, Ordering};

/// A publisher of messages of one type.
#[derive(Debug)]
pub struct Publisher<T> {
    id: PublisherId,
    message: PhantomData<fn(&T)>,
}

impl<T: Message> Publisher<T> {
    /// Advertises `topic`, which must be of type `T` in the topic table.
    ///
    /// # Panics
    /// If the topic table gives the topic another type: an error in the node's code.
    pub fn advertise(bus: &mut dyn Bus, topic: &Topic) -> Result<Self, BusError> {
        assert_eq!(topic.info.type_name, T::TYPE, "type of topic {}", topic.name);
        Ok(Self { id: bus.advertise(topic)?, message: PhantomData })
    }

    /// Encodes and publishes; returns the RTPS sequence number.
    pub fn publish(&self, bus: &mut dyn Bus, message: &T) -> Result<i64, BusError> {
        bus.publish(self.id, &to_cdr(message))
    }

    /// Publishes a message that refers to a received sample; see [`SampleInfo::about`].
    pub fn publish_about(&self, bus: &mut dyn Bus, message: &T, about: SampleId) -> Result<i64, BusError> {
        bus.publish_about(self.id, &to_cdr(message), Some(about))
    }

    /// The raw handle, for [`Graph::readers`](crate::Graph::readers) and for bodies that are already encoded.
    pub fn id(&self) -> PublisherId {
        self.id
    }
}

/// A subscription to messages of one type.
#[derive(Debug)]
pub struct Subscription<T> {
    id: SubscriptionId,
    undecodable: AtomicU64,
    message: PhantomData<fn() -> T>,
}

impl<T: Message> Subscription<T> {
    /// Subscribes to `topic`, which must be of type `T` in the topic table.
    ///
    /// # Panics
    /// If the topic table gives the topic another type: an error in the node's code.
    pub fn subscribe(bus: &mut dyn Bus, topic: &Topic, demand: Demand) -> Result<Self, BusError> {
        assert_eq!(topic.info.type_name, T::TYPE, "type of topic {}", topic.name);
        let id = bus.subscribe(topic, demand)?;
        Ok(Self { id, undecodable: AtomicU64::new(0), message: PhantomData })
    }

    /// The next message that decodes, if any; others are counted and logged.
    pub fn take_valid(&self, bus: &mut dyn Bus) -> Result<Option<(T, SampleInfo)>, BusError> {
        while let Some(sample) = bus.take(self.id)? {
            let SampleInfo { sequence, writer, .. } = sample.info;
            match from_cdr(&sample.body) {
                Ok(message) => return Ok(Some((message, sample.info))),
                Err(reason) => {
                    bus.count_refused(self.id);
                    // A flood of such samples must not fill the disk with lines.
                    let count = self.undecodable.fetch_add(1, Ordering::Relaxed) + 1;
                    if count.is_power_of_two() {
                        log::warn!(
                            "sample {sequence} of writer {writer} refused: {reason} ({count} so far do not decode)"
                        );
                    }
                }
            }
        }
        Ok(None)
    }

    /// The raw handle, for [`Graph::writers`](crate::Graph::writers) and [`Statistics::count_refused`](crate::Statistics::count_refused).
    pub fn id(&self) -> SubscriptionId {
        self.id
    }
}
