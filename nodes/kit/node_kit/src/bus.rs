//! The bus: a node's interface to the network. There are two implementations, over DDS and in memory.

use crate::BULK_LIMIT;
use crate::bus_error::BusError;
use crate::demand::Demand;
use crate::graph::Graph;
use crate::handles::{PublisherId, SubscriptionId};
use crate::sample::{Sample, SampleId};
use crate::statistics::Statistics;
use grainlab_msgs::Topic;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

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
/// A middleware implements this trait, [`Graph`] and [`Statistics`]. Names are resolved with the node's namespace and remaps.
/// The topic table states the QoS.
pub trait Bus: Graph + Statistics {
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
    /// calls, or `timeout` has passed. Returns [`Wake::Data`] at once while a sample is left untaken.
    fn wait(&mut self, timeout: Duration) -> Wake;

    /// A handle for another thread to end [`Bus::wait`]. `None` on a bus with virtual time, where results must not
    /// depend on the speed of a thread.
    fn caller(&self) -> Option<Caller>;

    /// A flag that is true once the process was asked to end, for computations that take long; `None` on a bus without
    /// signals.
    fn stop_flag(&self) -> Option<Arc<AtomicBool>>;

    /// Largest body that is sent as one sample, bytes; see [`crate::BulkPublisher`].
    fn longest_sample(&self) -> usize {
        BULK_LIMIT
    }

    /// Name of the transport, for the recording.
    fn transport(&self) -> &'static str;

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
