//! The one file that calls RustDDS directly, for what ros2-client does not offer.
//!
//! ros2-client makes the node, its topics, endpoints, graph, parameters and services. Directly from RustDDS come:
//!
//! - [`context`]: the options of a participant. ros2-client takes a domain only; a run needs its GUID prefix, its filter of
//!   strangers, and the interfaces.
//! - [`RawAdapter`]: samples as bytes. Recorder and player know no types, and a node refuses a sample that does not decode
//!   without losing those behind it.
//! - [`offered`], [`requested`]: resource limits, which `QosProfile` lacks. The default of 64 samples loses data silently.
//! - [`RawPublisher`]: a publisher with the sequence numbers that it wrote, the sample that a message refers to, and waiting for
//!   acknowledgements.
//! - [`RawSubscription`]: a subscription with sequence numbers and source times.
//! - [`Discovery`]: changes of the graph. ros2-client's spinner reports no lost participants, and subscribes to `/clock` with
//!   a type that is not `rosgraph_msgs/Clock`.

use super::gate::Gate;
use super::network::{Network, Reach};
use crate::bus_error::{BusError, create_error};
use crate::demand::Demand;
use crate::free_domain::no_participant;
use crate::identity::may_be_ours;
use crate::offer::{Offer, user_data, wire_type};
use crate::sample::{Sample, SampleId, SampleInfo};
use grainlab_msgs::{Guid, Qos, Topic};
use ros2_client::{Context, Node};
use rustdds::bytes::Bytes;
use rustdds::dds::{ReadError, WriteError};
use rustdds::no_key::{
    DataWriter, Decode, DefaultDecoder, DeserializedCacheChange, DeserializerAdapter, SerializerAdapter,
    SimpleDataReader,
};
use rustdds::policy::{Deadline, Durability, History, Lifespan, Liveliness, Reliability, ResourceLimits};
use rustdds::{
    DomainParticipantBuilder, DomainParticipantStatusEvent as Event, DomainParticipantStatusListener,
    Duration, GUID, GuidPrefix, QosPolicies, QosPolicyBuilder, RTPSEntity, RepresentationIdentifier,
    SampleIdentity, SequenceNumber, StatusEvented, Timestamp, TopicKind, WriteOptionsBuilder,
};
use std::convert::Infallible;
use std::io;
use std::net::Ipv4Addr;
use std::sync::Arc;

/// The module path under which RustDDS logs.
pub(crate) const LOG_TARGET: &str = "rustdds";

pub(super) type DdsTopic = rustdds::Topic;

/// The topic of DDS with this name for messages of this type: ros2-client makes those of kind `msg` alone.
pub(super) fn topic(context: &Context, name: String, type_name: &str) -> Result<DdsTopic, BusError> {
    let created = context.domain_participant().create_topic(
        name.clone(),
        wire_type(type_name),
        &QosPolicies::builder().build(),
        TopicKind::NoKey,
    );
    created.map_err(|e| create_error(&name, &e))
}

// ---- Participant

fn builder(network: Network) -> DomainParticipantBuilder {
    let builder = DomainParticipantBuilder::new(network.domain).initial_peers(network.peers.iter());
    let builder = match network.interface {
        Some(address) => builder.with_only_networks([Ipv4Addr::LOCALHOST, address]),
        None => builder,
    };
    match network.reach {
        Reach::Localhost if network.peers.is_empty() => builder.with_only_networks([Ipv4Addr::LOCALHOST]),
        Reach::Localhost => builder.with_multicast_only_on([Ipv4Addr::LOCALHOST]),
        Reach::Subnet => builder,
    }
}

impl Network {
    /// A ros2-client context in this network: a participant outside all runs, for tools and tests.
    ///
    /// # Errors
    /// If DDS cannot open its sockets.
    pub fn context(&self) -> Result<Context, BusError> {
        let ours = |guid: GUID| may_be_ours(&Guid(guid.to_bytes()).participant());
        let participant = builder(*self).participant_listener(move |peer| ours(peer.guid)).build();
        let participant = participant.map_err(|e| no_participant(self.domain, &e))?;
        Context::from_domain_participant(participant).map_err(|e| create_error("ROS context", &e))
    }
}

pub(super) fn context(network: Network, prefix: [u8; 12], gate: &Arc<Gate>) -> Result<Context, BusError> {
    let create = || {
        let [filter, listener, readers, reception] = std::array::from_fn(|_| Arc::clone(gate));
        builder(network)
            .guid_prefix(GuidPrefix::new(&prefix))
            .data_filter(move |writer, reader| filter.takes(Guid(writer.to_bytes()), Guid(reader.to_bytes())))
            .reception_listener(move |writer, reader, event| {
                reception.learnt(Guid(writer.to_bytes()), Guid(reader.to_bytes()), event);
            })
            .participant_listener(move |peer| {
                listener.discovered(Guid(peer.guid.to_bytes()), &peer.metatraffic_unicast_addresses)
            })
            // Readers outside the run receive what is sent, and are not waited for.
            .reader_may_block(move |prefix| readers.admits_prefix(prefix.as_ref()))
            .build()
    };
    // RustDDS gives its threads ten seconds to start; a process that was suspended meanwhile tries once more.
    let participant = create().or_else(|_| create()).map_err(|e| no_participant(network.domain, &e))?;
    Context::from_domain_participant(participant).map_err(|e| create_error("ROS context", &e))
}

// ---- Samples as bytes

/// Bytes of the encapsulation header: representation identifier and options.
pub(super) const HEADER: usize = 4;
/// Plain CDR, little endian: the representation of all that we serialize.
pub(super) const CDR_LE: [u8; 2] = [0, 1];
/// Plain CDR, big endian: messages of other programs, played from a recording.
pub(super) const CDR_BE: [u8; 2] = [0, 0];

/// A received sample: header and payload.
struct RawBody(Vec<u8>);

/// A sample to send: the payload behind the header, and its byte order.
struct RawPayload {
    bytes: Bytes,
    big_endian: bool,
}

struct RawAdapter;

/// Restores the header that RustDDS removed, so that a body has all bytes of the sample.
#[derive(Clone)]
struct KeepBytes;

impl<'de> Decode<'de, RawBody> for KeepBytes {
    type Error = Infallible;

    fn decode_bytes(
        self,
        payload: &'de [u8],
        encoding: RepresentationIdentifier,
    ) -> Result<RawBody, Infallible> {
        let representation =
            ENCODINGS.iter().position(|known| *known == encoding).map_or(CDR_LE, |i| IDENTIFIERS[i]);
        let mut body = Vec::with_capacity(HEADER + payload.len());
        body.extend_from_slice(&representation);
        body.extend_from_slice(&[0, 0]);
        body.extend_from_slice(payload);
        Ok(RawBody(body))
    }
}

/// Representations taken as they are, and their identifiers on the wire; RustDDS hides the bytes of its constants.
static ENCODINGS: [RepresentationIdentifier; 4] = [
    RepresentationIdentifier::CDR_LE,
    RepresentationIdentifier::CDR_BE,
    RepresentationIdentifier::PL_CDR_LE,
    RepresentationIdentifier::PL_CDR_BE,
];
const IDENTIFIERS: [[u8; 2]; 4] = [CDR_LE, CDR_BE, [0, 3], [0, 2]];

impl DeserializerAdapter<RawBody> for RawAdapter {
    type Error = Infallible;
    type Decoded = RawBody;

    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        &ENCODINGS
    }

    fn transform_decoded(decoded: RawBody) -> RawBody {
        decoded
    }
}

impl DefaultDecoder<RawBody> for RawAdapter {
    type Decoder = KeepBytes;
    const DECODER: KeepBytes = KeepBytes;
}

impl SerializerAdapter<RawPayload> for RawAdapter {
    type Error = Infallible;

    fn output_encoding() -> RepresentationIdentifier {
        RepresentationIdentifier::CDR_LE
    }

    fn encoding_of(value: &RawPayload) -> RepresentationIdentifier {
        if value.big_endian { RepresentationIdentifier::CDR_BE } else { RepresentationIdentifier::CDR_LE }
    }

    fn to_bytes(value: &RawPayload) -> Result<Bytes, Infallible> {
        Ok(value.bytes.clone())
    }
}

// ---- QoS with limits

/// Time for which a reliable write waits while its window is full. Longer than one repair round (10 ms), much shorter than a
/// step of the slowest node, so that a crashed reader delays a writer but never stops it.
const MAX_BLOCKING: Duration = Duration::from_millis(20);

/// Unacknowledged samples of a stream. A crashed reader stays matched for up to a minute; at a servo's highest rate of
/// some kHz the window fills within seconds, and then each sample costs [`MAX_BLOCKING`].
const STREAM_WINDOW: u32 = 8192;

/// Unacknowledged samples of a latched topic: these are megabytes each, and a few per minute.
const LATCHED_WINDOW: u32 = 256;

pub(super) fn window(topic: &Topic) -> u32 {
    let window = if topic.qos.transient_local && topic.qos.depth < LATCHED_WINDOW {
        LATCHED_WINDOW
    } else {
        STREAM_WINDOW
    };
    window.max(topic.qos.depth)
}

fn offered(topic: &Topic) -> QosPolicies {
    let qos = topic.qos;
    let offered = policies(qos.reliable, qos.transient_local, qos.depth, window(topic));
    match user_data(&topic.info) {
        Some(data) => offered.with_user_data(data),
        None => offered,
    }
}

/// The policies that a reader requests; `demand` is within the topic's QoS already.
fn requested(topic: &Topic, demand: Demand) -> QosPolicies {
    // RustDDS keeps 64 samples by default: too few for a recorder, too many for packings of megabytes.
    policies(demand.reliable, demand.reliable && topic.qos.transient_local, demand.depth, demand.burst)
}

/// Offer of another process. A policy that is not announced has the default of DDS; the depth is announced by few
/// implementations, and 0 if unknown.
fn offered_by(qos: &QosPolicies) -> Qos {
    let depth = match qos.history() {
        Some(History::KeepLast { depth }) => u32::try_from(depth).unwrap_or(0),
        Some(History::KeepAll) | None => 0,
    };
    Qos {
        reliable: !matches!(qos.reliability(), Some(Reliability::BestEffort)),
        transient_local: !matches!(qos.durability(), Some(Durability::Volatile) | None),
        depth,
    }
}

/// The policies of which more is requested than offered, and how the tools of the command line set them.
fn unfit(requested: &QosPolicies, offered: &QosPolicies) -> String {
    let [wanted, given] = [offered_by(requested), offered_by(offered)];
    let all = [
        ("reliability", wanted.reliable && !given.reliable, ["reliable", "best_effort"]),
        ("durability", wanted.transient_local && !given.transient_local, ["transient_local", "volatile"]),
    ];
    let unfit = all.into_iter().filter(|(_, unfit, _)| *unfit);
    let list: Vec<String> = unfit
        .map(|(policy, _, [more, less])| {
            format!("{policy}, requested {more}, offered {less} (--qos-{policy} {more} or {less})")
        })
        .collect();
    match offered.compliance_failure_wrt(requested) {
        Some(other) if list.is_empty() => format!("{other:?}").to_lowercase(),
        _ => list.join("; "),
    }
}

fn policies(reliable: bool, transient_local: bool, depth: u32, max_samples: u32) -> QosPolicies {
    let clamped = |n: u32| i32::try_from(n).unwrap_or(i32::MAX);
    QosPolicyBuilder::new()
        .reliability(if reliable {
            Reliability::Reliable { max_blocking_time: MAX_BLOCKING }
        } else {
            Reliability::BestEffort
        })
        .durability(if transient_local { Durability::TransientLocal } else { Durability::Volatile })
        .history(History::KeepLast { depth: clamped(depth) })
        .resource_limits(ResourceLimits {
            max_samples: clamped(max_samples),
            max_instances: 1,
            max_samples_per_instance: clamped(max_samples),
        })
        .deadline(Deadline(Duration::INFINITE))
        .lifespan(Lifespan { duration: Duration::INFINITE })
        .liveliness(Liveliness::Automatic { lease_duration: Duration::INFINITE })
        .build()
}

// ---- Publisher

pub(super) struct RawPublisher(DataWriter<RawPayload, RawAdapter>);

impl RawPublisher {
    pub(super) fn new(node: &mut Node, dds: &DdsTopic, topic: &Topic) -> Result<Self, BusError> {
        let writer = node.create_datawriter(dds, Some(offered(topic)));
        writer.map(Self).map_err(|e| create_error(topic.name, &e))
    }

    pub(super) fn guid(&self) -> Guid {
        Guid(self.0.guid().to_bytes())
    }

    /// Writes a body, in CDR with its encapsulation header, and returns its sequence number; `None` if the window stayed
    /// full.
    pub(super) fn write(&self, body: &[u8], about: Option<SampleId>) -> Result<Option<i64>, String> {
        let (header, payload) = body.split_at(HEADER.min(body.len()));
        let related = about.map(|sample| SampleIdentity {
            writer_guid: GUID::from_bytes(sample.writer.0),
            sequence_number: SequenceNumber::from(sample.sequence),
        });
        let options = WriteOptionsBuilder::new()
            .source_timestamp(Timestamp::now())
            .related_sample_identity_opt(related)
            .build();
        // RTPS pads a sample in one datagram to whole words, and leaves fragments as they are. So both give the same bytes.
        let mut padded = payload.to_vec();
        padded.resize(payload.len().next_multiple_of(4), 0);
        let big_endian = header.starts_with(&CDR_BE);
        match self.0.write_with_options(RawPayload { bytes: Bytes::from(padded), big_endian }, options) {
            Ok(identity) => Ok(Some(i64::from(identity.sequence_number))),
            Err(WriteError::WouldBlock { .. }) => Ok(None),
            Err(WriteError::Io(error)) => Err(error.to_string()),
            Err(error) => Err(error.to_string()),
        }
    }

    /// Waits until every reliable reader has acknowledged everything; false if it has not within `timeout`.
    pub(super) fn wait_for_acknowledgments(&self, timeout: std::time::Duration) -> bool {
        self.0.wait_for_acknowledgments(timeout).unwrap_or(false)
    }

    /// Number of samples that some reliable reader has not acknowledged.
    pub(super) fn unacknowledged(&self) -> u64 {
        self.0.unacknowledged_samples()
    }

    /// True if every matched reliable reader has answered this writer.
    pub(super) fn is_known_to_readers(&self) -> bool {
        self.0.is_known_to_matched_readers()
    }
}

// ---- Subscription

pub(super) enum TakeFailure {
    /// The representation is not CDR; the next call takes the sample after it.
    Representation(String),
    Other(String),
}

pub(super) struct RawSubscription(SimpleDataReader<RawBody, RawAdapter>);

impl RawSubscription {
    pub(super) fn new(
        node: &mut Node,
        dds: &DdsTopic,
        topic: &Topic,
        demand: Demand,
    ) -> Result<Self, BusError> {
        let reader = node.create_simpledatareader(dds, Some(requested(topic, demand)));
        reader.map(Self).map_err(|e| create_error(topic.name, &e))
    }

    pub(super) fn guid(&self) -> Guid {
        Guid(self.0.guid().to_bytes())
    }

    pub(super) fn source(&mut self) -> &mut impl mio::event::Source {
        &mut self.0
    }

    /// Clears the notification, so that the next sample raises a new one. Before reading, never after.
    pub(super) fn acknowledge(&self) {
        self.0.drain_read_notifications();
    }

    pub(super) fn take(&self) -> Result<Option<Sample>, TakeFailure> {
        match self.0.try_take_one() {
            Ok(change) => Ok(change.map(sample)),
            Err(ReadError::Deserialization { reason }) => Err(TakeFailure::Representation(reason)),
            Err(error) => Err(TakeFailure::Other(error.to_string())),
        }
    }
}

fn sample(change: DeserializedCacheChange<RawBody>) -> Sample {
    let info = SampleInfo {
        writer: Guid(change.writer_guid.to_bytes()),
        sequence: i64::from(change.sequence_number),
        source_time: change.source_timestamp().filter(|t| *t != Timestamp::INVALID).map(nanos),
        received: nanos(change.receive_instant),
        about: change.related_sample_identity().map(|sample| SampleId {
            writer: Guid(sample.writer_guid.to_bytes()),
            sequence: i64::from(sample.sequence_number),
        }),
    };
    Sample { body: change.into_value().0, info }
}

/// Returns the wall-clock time of this process, ns since 1970. It never goes back, in any thread: if the clock of the host is set
/// back, it goes on from where it was.
pub(crate) fn wall_nanos() -> u64 {
    nanos(Timestamp::now())
}

/// An RTPS time (2⁻³² s since 1970) in nanoseconds.
fn nanos(time: Timestamp) -> u64 {
    let ticks = time.to_ticks();
    let fraction = ((ticks & 0xffff_ffff) * 1_000_000_000 + (1 << 31)) >> 32;
    (ticks >> 32) * 1_000_000_000 + fraction
}

// ---- Graph

pub(super) enum Change {
    /// A writer of another process, with its DDS topic and what it offers there if that is a topic of ROS.
    Writer {
        writer: Guid,
        topic: String,
        offer: Option<Offer>,
    },
    /// An endpoint of this process was matched.
    Matched {
        local: Guid,
        remote: Guid,
    },
    Lost(Guid),
    /// A participant is gone: its GUID prefix.
    ParticipantLost([u8; 12]),
    /// Two endpoints do not fit, in words.
    Misfit(String),
    Other,
}

/// The queue of changes of the graph.
///
/// The endpoints' own status channels hold four events and drop the rest; the participant's holds 2048.
pub(super) struct Discovery(DomainParticipantStatusListener);

impl Discovery {
    pub(super) fn new(context: &Context) -> Self {
        Self(context.domain_participant().status_listener())
    }

    pub(super) fn register(&mut self, registry: &mio::Registry, token: mio::Token) -> io::Result<()> {
        registry.register(self.0.as_status_source_mio1(), token, mio::Interest::READABLE)
    }

    pub(super) fn next(&self) -> Option<Change> {
        let misfit = |remote: GUID, what: &str, requested: &QosPolicies, offered: &QosPolicies| {
            let policies = unfit(requested, offered);
            Change::Misfit(format!("{what} ({}): {policies}", Guid(remote.to_bytes())))
        };
        Some(match self.0.try_recv_status()? {
            Event::WriterDetected { writer } => {
                let id = Guid(writer.guid.to_bytes());
                let qos = offered_by(&writer.qos);
                let offer = Offer::of_wire(id, &writer.topic_name, &writer.type_name, qos, &writer.user_data);
                Change::Writer { writer: id, topic: writer.topic_name, offer }
            }
            Event::RemoteReaderMatched { local_writer: local, remote_reader: remote }
            | Event::RemoteWriterMatched { local_reader: local, remote_writer: remote } => {
                Change::Matched { local: Guid(local.to_bytes()), remote: Guid(remote.to_bytes()) }
            }
            Event::WriterLost { guid, .. } | Event::ReaderLost { guid, .. } => {
                Change::Lost(Guid(guid.to_bytes()))
            }
            Event::ParticipantLost { id, .. } => {
                <[u8; 12]>::try_from(id.as_ref()).map_or(Change::Other, Change::ParticipantLost)
            }
            Event::RemoteReaderQosIncompatible { remote_reader, requested_qos, offered_qos, .. } => misfit(
                remote_reader,
                "a reader requests more than this process offers and receives nothing: offer what it requests",
                &requested_qos,
                &offered_qos,
            ),
            Event::RemoteWriterQosIncompatible { remote_writer, requested_qos, offered_qos, .. } => misfit(
                remote_writer,
                "a writer offers less than this process requests, so that its samples are not received: request what it offers",
                &requested_qos,
                &offered_qos,
            ),
            Event::InconsistentTopic { previous_topic_data, discovered_topic_data, .. } => {
                let [ours, theirs] = [&previous_topic_data, &discovered_topic_data].map(|t| &t.type_name);
                let name = &previous_topic_data.name;
                Change::Misfit(format!("{name} has two types: {ours} and {theirs}"))
            }
            _ => Change::Other,
        })
    }
}

#[cfg(test)]
mod tests;
