//! The counts of a bus.

use crate::announced::Announced;
use crate::bus_error::BusError;
use crate::handles::{PublisherId, SubscriptionId};
use grainlab_msgs::{Published, Received, Topic};

/// Numbers of messages that were sent, taken and refused.
pub trait Statistics {
    /// Counts one message of `topic` that `publisher`, a writer of another topic, sent in parts: [`Self::published`]
    /// lists it as if that writer were one of `topic`.
    fn count_published(&mut self, publisher: PublisherId, topic: &Topic) -> Result<(), BusError>;

    /// Returns the statistics of our writers, in the order of [`Bus::advertise`](crate::Bus::advertise).
    ///
    /// Messages sent in parts come before their writer.
    fn published(&self) -> Vec<Published>;

    /// Returns the statistics of our subscriptions, in the order of [`Bus::subscribe`](crate::Bus::subscribe).
    fn received(&self) -> Vec<Received>;

    /// Returns what each writer of another process announced to this subscription until now, also writers that left.
    fn announced(&self, subscription: SubscriptionId) -> Vec<Announced>;

    /// Counts a taken sample whose content was refused.
    fn count_refused(&mut self, subscription: SubscriptionId);
}
