//! The bus: what a node sees of the network. Two implementations exist, over DDS and in memory.

use crate::admission::Stranger;
use crate::bus_error::BusError;
use crate::demand::Demand;
use crate::identity::Identity;
use crate::sample::{Sample, SampleId, WriterId};
use grainlab_msgs::Topic;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

/// Handle of an advertised topic on one bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PublisherId(pub(crate) usize);

/// Handle of a subscription on one bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SubscriptionId(pub(crate) usize);

/// Why [`Bus::wait`] returned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wake {
    /// A subscription holds a sample.
    Data,
    /// A peer's endpoint appeared, matched or went.
    Graph,
    /// SIGINT or SIGTERM, once for each.
    Shutdown,
    /// Another thread called: see [`Bus::caller`].
    Called,
    /// Nothing, for the whole time.
    Timeout,
}

/// Ends the wait of a bus from another thread; see [`Bus::caller`].
#[derive(Clone)]
pub struct Caller(pub(crate) Arc<dyn Fn() + Send + Sync>);

impl Caller {
    /// The wait under way, or the next one, ends with [`Wake::Called`].
    pub fn call(&self) {
        (self.0)();
    }
}

impl fmt::Debug for Caller {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Caller")
    }
}

/// What one writer of ours published.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Published {
    /// Resolved topic name, as in `/lab/stress`.
    pub topic: String,
    /// Our writer.
    pub writer: WriterId,
    /// Samples accepted; the last one has this RTPS sequence number.
    pub count: u64,
    /// Samples refused because a reliable reader is too far behind.
    pub full: u64,
}

/// What one subscription of ours received.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Received {
    /// Resolved topic name.
    pub topic: String,
    /// Samples taken.
    pub taken: u64,
    /// Samples whose content was refused: undecodable, or invalid to the node.
    pub refused: u64,
}

/// The bus as a node sees it: serialized samples in and out, and one place to wait.
///
/// Names are resolved with the node's namespace and remaps; QoS comes from the contract table and nowhere else.
pub trait Bus {
    /// The name that a topic has here, namespace and remaps applied.
    fn resolve(&self, topic: &Topic) -> Result<String, BusError>;

    /// Offers a topic with the QoS of the contract table. Each call makes a writer of its own.
    fn advertise(&mut self, topic: &Topic) -> Result<PublisherId, BusError>;

    /// Subscribes to a topic. Each of several subscriptions to one topic gets everything that arrives.
    fn subscribe(&mut self, topic: &Topic, demand: Demand) -> Result<SubscriptionId, BusError>;

    /// Publishes one serialized message, encapsulation header included, and returns its RTPS sequence number.
    ///
    /// Waits at most some milliseconds for a reliable reader that is far behind, then drops the sample and says
    /// [`BusError::Full`].
    fn publish(&mut self, publisher: PublisherId, body: &[u8]) -> Result<i64, BusError> {
        self.publish_about(publisher, body, None)
    }

    /// The same of a message about a sample that came; see [`SampleInfo::about`].
    fn publish_about(
        &mut self,
        publisher: PublisherId,
        body: &[u8],
        about: Option<SampleId>,
    ) -> Result<i64, BusError>;

    /// The next sample, if there is one. Never waits.
    fn take(&mut self, subscription: SubscriptionId) -> Result<Option<Sample>, BusError>;

    /// Blocks (never spins) until a subscription holds a sample, the graph changes, a signal comes, another thread calls, or
    /// `timeout` is over.
    /// Returns [`Wake::Data`] at once while a sample is left untaken.
    fn wait(&mut self, timeout: Duration) -> Wake;

    /// What another thread ends [`Bus::wait`] with. `None` on a bus whose time is virtual: nothing may happen there that
    /// depends on how fast a thread is.
    fn caller(&self) -> Option<Caller>;

    /// Readers matched with this publisher, of those that [`Bus::identity`] counts, as known at the last [`Bus::wait`]. A crashed peer counts until its lease
    /// ends, up to a minute: see [`crate::Peers`].
    fn readers(&self, publisher: PublisherId) -> usize;

    /// Writers matched with this subscription, of those that [`Bus::identity`] counts, as known at the last [`Bus::wait`].
    fn writers(&self, subscription: SubscriptionId) -> usize;

    /// Writers on the resolved topic that are not this process's own, of those that [`Bus::identity`] counts, sorted, as known at the last [`Bus::wait`].
    fn foreign_writers(&self, topic: &Topic) -> Vec<WriterId>;

    /// Writers on the resolved topic whose samples are not taken, sorted, as known at the last [`Bus::wait`].
    fn strange_writers(&self, topic: &Topic) -> Vec<WriterId>;

    /// Counts one message of `topic` that `publisher`, a writer of another topic, sent in parts: [`Bus::published`] tells of
    /// it as if that writer were one of `topic`.
    fn count_published(&mut self, publisher: PublisherId, topic: &Topic) -> Result<(), BusError>;

    /// What our writers published, in the order of [`Bus::advertise`]; what one of them published in parts stands before it.
    fn published(&self) -> Vec<Published>;

    /// What our subscriptions received, in the order of [`Bus::subscribe`].
    fn received(&self) -> Vec<Received>;

    /// Counts a taken sample whose content was refused.
    fn count_refused(&mut self, subscription: SubscriptionId);

    /// What this process is to its run: whose samples it takes.
    fn identity(&self) -> Identity;

    /// Who wrote samples that were not taken, because they are of another run or of none, and how many.
    fn strangers(&self) -> Vec<Stranger>;

    /// Who has this writer, for people.
    fn describe(&self, writer: WriterId) -> Stranger;

    /// Waits until every reliable reader has acknowledged everything, or `timeout` is over; true in the first case. Topics
    /// that this bus reads reliably itself are left out: nobody can tell there.
    fn flush(&mut self, timeout: Duration) -> bool;

    /// Time since an arbitrary start, never going back; virtual on the in-memory bus.
    fn now(&self) -> Duration;

    /// Wall-clock time, ns since 1970; virtual on the in-memory bus.
    fn wall_nanos(&self) -> u64;
}
