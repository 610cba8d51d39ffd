//! The endpoints and processes that a bus knows.

use crate::admission::{Participant, Stranger};
use crate::handles::{PublisherId, SubscriptionId};
use crate::identity::Identity;
use crate::offer::Offer;
use grainlab_msgs::{Guid, Topic};

/// Who else is on the network, as known at the last [`Bus::wait`](crate::Bus::wait).
///
/// Readers, writers and offers are those that [`Self::identity`] counts, unless a method says otherwise.
pub trait Graph {
    /// Returns the number of readers matched with this publisher.
    ///
    /// A crashed peer counts until its lease ends, up to a minute: see [`crate::PeerWatch`].
    fn readers(&self, publisher: PublisherId) -> usize;

    /// Returns true if anybody reads this publisher, also a stranger.
    fn is_read(&self, publisher: PublisherId) -> bool;

    /// Returns the number of writers matched with this subscription.
    fn writers(&self, subscription: SubscriptionId) -> usize;

    /// Returns the writers on the resolved topic that are not this process's own, sorted.
    fn foreign_writers(&self, topic: &Topic) -> Vec<Guid>;

    /// Returns the participants with a writer on the resolved topic whose messages are not read, sorted.
    ///
    /// Their messages are of another type, or of another definition of the type.
    fn misfits(&self, _topic: &Topic) -> Vec<Participant> {
        Vec::new()
    }

    /// Returns the offers of the writers of other processes on topics of ROS, in the order of topics.
    fn offers(&self) -> Vec<Offer>;

    /// Returns the offers of writers whose samples are not taken.
    fn strange_offers(&self) -> Vec<Offer> {
        Vec::new()
    }

    /// The process's place in its run, and whose samples it accepts.
    fn identity(&self) -> Identity;

    /// Returns the participants whose samples were ignored because they belong to another run or to none, with counts.
    fn strangers(&self) -> Vec<Stranger>;

    /// Returns the owner of this writer, for messages to users.
    fn describe(&self, writer: Guid) -> Stranger;

    /// Returns a sentence about participants that are ignored because the domain is full; `None` if none is.
    fn crowding(&self) -> Option<String> {
        None
    }
}
