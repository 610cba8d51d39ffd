//! The bus: what a node sees of the network. Two implementations exist, over DDS and in memory.

use crate::admission::Stranger;
use crate::identity::Identity;
use crate::names::NameError;
use grainlab_msgs::Topic;
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;
use std::time::Duration;

/// The 16-byte GUID of one writer, as RTPS has it: 12 bytes of participant, 4 of entity. Unique among all processes.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct WriterId(pub [u8; 16]);

impl WriterId {
    /// Stands for every writer of a participant: its entity is zero.
    pub fn of_participant(participant: [u8; 12]) -> Self {
        let mut id = [0; 16];
        id[..12].copy_from_slice(&participant);
        Self(id)
    }

    /// The 12 bytes that every endpoint of one process shares.
    pub fn participant(&self) -> [u8; 12] {
        let mut prefix = [0; 12];
        prefix.copy_from_slice(&self.0[..12]);
        prefix
    }
}

/// 32 hexadecimal digits.
impl fmt::Display for WriterId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for WriterId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "WriterId({self})")
    }
}

/// Text that is not 32 hexadecimal digits.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not a writer id: 32 hexadecimal digits")]
pub struct WriterIdError(pub String);

impl FromStr for WriterId {
    type Err = WriterIdError;

    fn from_str(text: &str) -> Result<Self, WriterIdError> {
        let error = || WriterIdError(text.into());
        if text.len() != 32 || !text.is_ascii() {
            return Err(error());
        }
        let mut bytes = [0; 16];
        for (i, byte) in bytes.iter_mut().enumerate() {
            *byte = u8::from_str_radix(&text[2 * i..2 * i + 2], 16).map_err(|_| error())?;
        }
        Ok(WriterId(bytes))
    }
}

/// One received sample, undecoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sample {
    /// The serialized message with its 4-byte encapsulation header.
    pub body: Vec<u8>,
    /// Where it came from, and in which place of that writer's sequence.
    pub info: SampleInfo,
}

/// Origin and times of one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleInfo {
    /// Who wrote it.
    pub writer: WriterId,
    /// RTPS sequence number: 1, 2, 3, … for each writer; a missing number is a lost sample.
    pub sequence: i64,
    /// When the writer says it wrote it, ns since 1970; `None` if it does not say.
    pub source_time: Option<u64>,
    /// When it reached this process, ns since 1970.
    pub received: u64,
    /// The sample that it is about, where its writer says one: the request that an answer answers, the packing that a
    /// result was measured of. It travels beside the body, as DDS-RPC relates a reply to its request.
    pub about: Option<SampleId>,
}

impl SampleInfo {
    /// The sample itself, for those about it.
    pub fn id(&self) -> SampleId {
        SampleId { writer: self.writer, sequence: self.sequence }
    }

    /// What a result from this sample is about: what the sample is about, or the sample itself.
    pub fn origin(&self) -> SampleId {
        self.about.unwrap_or_else(|| self.id())
    }
}

/// One sample of one writer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SampleId {
    /// Who wrote it.
    pub writer: WriterId,
    /// Its RTPS sequence number.
    pub sequence: i64,
}

/// What a subscription asks of its writers. It asks at most what the topic offers, so that it always matches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Demand {
    /// Lost samples are sent again, and a latched topic's last samples come to a late joiner.
    pub reliable: bool,
    /// Samples kept between two takes; older ones give way. At least the worst backlog.
    pub depth: u32,
}

impl Demand {
    /// Every sample, and the latched ones for a late joiner: at least the topic's depth of them, possibly more.
    pub const fn reliable(depth: u32) -> Self {
        Self { reliable: true, depth }
    }

    /// No repetition by the bus: for partners that repeat by themselves, and that must not hold up a writer when dead.
    pub const fn best_effort(depth: u32) -> Self {
        Self { reliable: false, depth }
    }

    /// The demand that `topic` can meet.
    pub fn within(self, topic: &Topic) -> Self {
        Self { reliable: self.reliable && topic.qos.reliable, depth: self.depth.max(1) }
    }

    /// Whether a subscription with this demand also serves `other`.
    pub fn covers(self, other: Self) -> bool {
        self.reliable >= other.reliable && self.depth >= other.depth
    }
}

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

/// Why the bus could not do what was asked.
#[derive(Debug, thiserror::Error)]
pub enum BusError {
    /// A topic name that does not resolve.
    #[error("topic name: {0}")]
    Name(#[from] NameError),
    /// A reliable reader is so far behind that the window stayed full for the whole bounded wait. The sample was dropped.
    #[error("{topic}: a reliable reader is more than {window} samples behind; the sample was dropped")]
    Full {
        /// Resolved topic name.
        topic: String,
        /// Samples that may be unacknowledged.
        window: u32,
    },
    /// A body that cannot be published as it is.
    #[error(
        "{topic}: cannot publish a body that begins {found:02x?}: it must begin 00 01 (CDR, little endian)"
    )]
    Encapsulation {
        /// Resolved topic name.
        topic: String,
        /// Its first bytes, at most four.
        found: Vec<u8>,
    },
    /// A handle of another bus.
    #[error("{0}: this handle does not belong to this bus")]
    Handle(&'static str),
    /// The network refused.
    #[error("{what}: {reason}")]
    Network {
        /// What was attempted.
        what: String,
        /// What the layer below said.
        reason: String,
    },
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

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_msgs::topics;

    #[test]
    fn writer_ids_read_back_from_their_hexadecimal_form() {
        let id = WriterId(std::array::from_fn(|i| (i * 17) as u8));
        assert_eq!(id.to_string(), "00112233445566778899aabbccddeeff");
        assert_eq!(id.to_string().parse(), Ok(id));
        for bad in ["", "0011", "zz112233445566778899aabbccddeeff", "é0112233445566778899aabbccddeef"] {
            assert!(bad.parse::<WriterId>().is_err(), "{bad}");
        }
    }

    #[test]
    fn a_demand_never_exceeds_what_the_topic_offers() {
        let of_clock = Demand::reliable(20_000).within(&topics::CLOCK);
        assert_eq!(of_clock.reliable, topics::CLOCK.qos.reliable);
        assert!(Demand::reliable(10).within(&topics::PACKING).reliable);
        assert_eq!(Demand::best_effort(0).within(&topics::PACKING), Demand::best_effort(1));
    }
}
