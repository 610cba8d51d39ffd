//! Typed handles over the raw bus.

use crate::bus::{Bus, PublisherId, SubscriptionId};
use crate::bus_error::BusError;
use crate::demand::Demand;
use crate::sample::{SampleId, SampleInfo};
use grainlab_msgs::{DecodeError, Message, Topic, from_cdr, to_cdr};
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

    /// The same for a message that refers to a received sample; see [`SampleInfo::about`].
    pub fn publish_about(&self, bus: &mut dyn Bus, message: &T, about: SampleId) -> Result<i64, BusError> {
        bus.publish_about(self.id, &to_cdr(message), Some(about))
    }

    /// The raw handle, for [`Bus::readers`] and for bodies that are already encoded.
    pub fn id(&self) -> PublisherId {
        self.id
    }
}

/// Errors of [`Subscription::take`].
#[derive(Debug, thiserror::Error)]
pub enum TakeError {
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// A sample does not decode as the type. It is counted as refused; the next call takes the sample after it.
    #[error("sample {} of writer {} refused: {reason}", info.sequence, info.writer)]
    Decode {
        /// The sample.
        info: SampleInfo,
        /// The error of decoding.
        reason: DecodeError,
    },
}

/// A subscription to messages of one type.
#[derive(Debug)]
pub struct Subscription<T> {
    id: SubscriptionId,
    /// Number of samples that did not decode.
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

    /// The next message, if any. An error concerns one sample; later ones can still be taken.
    pub fn take(&self, bus: &mut dyn Bus) -> Result<Option<(T, SampleInfo)>, TakeError> {
        let Some(sample) = bus.take(self.id)? else { return Ok(None) };
        match from_cdr(&sample.body) {
            Ok(message) => Ok(Some((message, sample.info))),
            Err(reason) => {
                bus.count_refused(self.id);
                Err(TakeError::Decode { info: sample.info, reason })
            }
        }
    }

    /// The next message that decodes, if any; others are counted and logged.
    pub fn take_valid(&self, bus: &mut dyn Bus) -> Result<Option<(T, SampleInfo)>, BusError> {
        loop {
            match self.take(bus) {
                Ok(taken) => return Ok(taken),
                Err(TakeError::Bus(error)) => return Err(error),
                Err(refused @ TakeError::Decode { .. }) => {
                    // A flood of such samples must not fill the disk with lines.
                    let count = self.undecodable.fetch_add(1, Ordering::Relaxed) + 1;
                    if count.is_power_of_two() {
                        log::warn!("{refused} ({count} so far do not decode)");
                    }
                }
            }
        }
    }

    /// The raw handle, for [`Bus::writers`] and [`Bus::count_refused`].
    pub fn id(&self) -> SubscriptionId {
        self.id
    }
}
