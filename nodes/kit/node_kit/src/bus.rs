//! The bus: a node's interface to the network. There are two implementations, over DDS and in memory.

use crate::BULK_LIMIT;
use crate::admission::{Participant, Stranger};
use crate::announced::Announced;
use crate::bus_error::BusError;
use crate::demand::Demand;
use crate::identity::Identity;
use crate::offer::Offer;
use crate::sample::{Sample, SampleId};
use grainlab_msgs::{Guid, Published, Received, Topic};
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Handle of an advertised topic on one bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PublisherId(pub(crate) usize);

/// Handle of a subscription on one bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SubscriptionId(pub(crate) usize);

/// The reason why [`Bus::wait`] returned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wake {
    /// A subscription holds a sample.
    Data,
    /// A peer's endpoint appeared, matched or left.
    Graph,
    /// SIGINT or SIGTERM, once for each.
    Shutdown,
    /// Another thread called: see [`Bus::caller`].
    Called,
    /// The time limit was reached.
    Timeout,
}

/// Ends the wait of a bus from another thread; see [`Bus::caller`].
#[derive(Clone)]
pub struct Caller(pub(crate) Arc<dyn Fn() + Send + Sync>);

impl Caller {
    /// Ends the current wait, or else the next one, with [`Wake::Called`].
    pub fn call(&self) {
        (self.0)();
    }
}

impl fmt::Debug for Caller {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Caller")
    }
}

/// Sends and receives serialized samples, and waits for events.
///
/// Names are resolved with the node's namespace and remaps; the QoS is always that of the topic table.
pub trait Bus {
    /// The resolved name of a topic: namespace and remaps applied.
    fn resolve(&self, topic: &Topic) -> Result<String, BusError>;

    /// Advertises a topic with the QoS of the topic table. Each call makes a separate writer.
    fn advertise(&mut self, topic: &Topic) -> Result<PublisherId, BusError>;

    /// Subscribes to a topic. Each of several subscriptions to one topic receives every sample.
    fn subscribe(&mut self, topic: &Topic, demand: Demand) -> Result<SubscriptionId, BusError>;

    /// Publishes one serialized message, encapsulation header included, and returns its RTPS sequence number.
    ///
    /// Waits at most some milliseconds for a reliable reader that is far behind, then drops the sample and returns
    /// [`BusError::Full`].
    fn publish(&mut self, publisher: PublisherId, body: &[u8]) -> Result<i64, BusError> {
        self.publish_about(publisher, body, None)
    }

    /// Publishes a message that refers to a received sample; see [`SampleInfo::about`](crate::SampleInfo::about).
    fn publish_about(
        &mut self,
        publisher: PublisherId,
        body: &[u8],
        about: Option<SampleId>,
    ) -> Result<i64, BusError>;

    /// The next sample, if any. Never waits.
    fn take(&mut self, subscription: SubscriptionId) -> Result<Option<Sample>, BusError>;

    /// Blocks (never spins) until a subscription holds a sample, the graph changes, a signal arrives, another thread
    /// calls, or
    /// `timeout` has passed.
    /// Returns [`Wake::Data`] at once while a sample is left untaken.
    fn wait(&mut self, timeout: Duration) -> Wake;

    /// A handle for another thread to end [`Bus::wait`]. `None` on a bus with virtual time, where results must not
    /// depend on the speed of a thread.
    fn caller(&self) -> Option<Caller>;

    /// Readers matched with this publisher, of those that [`Bus::identity`] counts, as known at the last [`Bus::wait`].
    /// A crashed peer counts until its lease ends, up to a minute: see [`crate::PeerWatch`].
    fn readers(&self, publisher: PublisherId) -> usize;

    /// True if anybody reads this publisher, also a stranger, as known at the last [`Bus::wait`].
    fn is_read(&self, publisher: PublisherId) -> bool;

    /// Number of messages of this publisher that some reliable reader, of those that [`Bus::identity`] counts, has not
    /// acknowledged yet.
    fn unacknowledged(&self, _publisher: PublisherId) -> u64 {
        0
    }

    /// True if every matched reliable reader has matched this publisher, too: each message from now on is due to it.
    fn is_known_to_readers(&self, _publisher: PublisherId) -> bool {
        true
    }

    /// Writers matched with this subscription, of those that [`Bus::identity`] counts, as known at the last
    /// [`Bus::wait`].
    fn writers(&self, subscription: SubscriptionId) -> usize;

    /// Writers on the resolved topic that are not this process's own, of those that [`Bus::identity`] counts, sorted,
    /// as known at the last [`Bus::wait`].
    fn foreign_writers(&self, topic: &Topic) -> Vec<Guid>;

    /// Participants with a writer on the resolved topic whose messages are not read: they are of another type, or of another
    /// definition of the type. Sorted.
    fn misfits(&self, _topic: &Topic) -> Vec<Participant> {
        Vec::new()
    }

    /// Offers of the writers of other processes on topics of ROS, of those that [`Bus::identity`] counts, in the order of
    /// topics, as known at the last [`Bus::wait`].
    fn offers(&self) -> Vec<Offer>;

    /// Offers of writers whose samples are not taken.
    fn strange_offers(&self) -> Vec<Offer> {
        Vec::new()
    }

    /// Counts one message of `topic` that `publisher`, a writer of another topic, sent in parts: [`Bus::published`]
    /// lists it as if that writer were one of `topic`.
    fn count_published(&mut self, publisher: PublisherId, topic: &Topic) -> Result<(), BusError>;

    /// The statistics of our writers, in the order of [`Bus::advertise`]; messages sent in parts come before their
    /// writer.
    fn published(&self) -> Vec<Published>;

    /// The statistics of our subscriptions, in the order of [`Bus::subscribe`].
    fn received(&self) -> Vec<Received>;

    /// What each writer of another process announced to this subscription until now, also writers that left.
    fn announced(&self, _subscription: SubscriptionId) -> Vec<Announced> {
        Vec::new()
    }

    /// Counts a taken sample whose content was refused.
    fn count_refused(&mut self, subscription: SubscriptionId);

    /// The process's place in its run, and whose samples it accepts.
    fn identity(&self) -> Identity;

    /// The participants whose samples were ignored because they belong to another run or to none, with counts.
    fn strangers(&self) -> Vec<Stranger>;

    /// The owner of this writer, for messages to users.
    fn describe(&self, writer: Guid) -> Stranger;

    /// A sentence about participants that are ignored because the domain is full; `None` if none is.
    fn crowding(&self) -> Option<String> {
        None
    }

    /// A flag that is true once the process was asked to end, for computations that take long; `None` on a bus without
    /// signals.
    fn stop_flag(&self) -> Option<Arc<AtomicBool>> {
        None
    }

    /// Largest body that is sent as one sample, bytes; see [`crate::BulkPublisher`].
    fn longest_sample(&self) -> usize {
        BULK_LIMIT
    }

    /// Name of the transport, for the recording.
    fn transport(&self) -> &'static str {
        "memory"
    }

    /// Waits until every reliable reader has acknowledged everything, or `timeout` has passed; true in the first case.
    /// Topics that this bus itself reads reliably are left out: their acknowledgements are not known.
    fn flush(&mut self, timeout: Duration) -> bool;

    /// Monotonic time since an arbitrary start; virtual on the in-memory bus.
    fn now(&self) -> Duration;

    /// Wall-clock time, ns since 1970; virtual on the in-memory bus.
    fn wall_nanos(&self) -> u64;

    /// Time of the node, ns since 1970: wall-clock time, or that of `/clock` while its parameter `use_sim_time` is true.
    fn node_nanos(&self) -> u64 {
        self.wall_nanos()
    }
}
