//! The bus over DDS.

use super::background_reader::{BackgroundReader, Inboxes};
use super::direct::{self, DdsTopic, Discovery, RawPublisher, RawSubscription};
use super::gate::Gate;
use super::graph::{Endpoints, Follower};
use super::inbox::Inbox;
use super::network::{CROWDING_ADVICE, Network, crowding};
use super::writer::Writer;
use crate::admission::{Participant, Stranger};
use crate::announced::Announced;
use crate::bus::{Bus, Caller, Wake};
use crate::bus_error::{BusError, create_error};
use crate::demand::Demand;
use crate::graph::Graph;
use crate::handles::{PublisherId, SubscriptionId};
use crate::identity::{Identity, Scope};
use crate::lock::lock;
use crate::names::Names;
use crate::offer::Offer;
use crate::parameters::Parameters;
use crate::sample::{Sample, SampleId};
use crate::services::{ServiceThread, SimTime};
use crate::statistics::Statistics;
use crate::watchdog::OpenParticipant;
use grainlab_console::Signals;
use grainlab_msgs::{Guid, Published, Received, Topic, TypeInfo};
use mio::{Events, Interest, Poll, Token, Waker};
use ros2_client::{Context, NodeName};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

mod fitting;

const SIGNALS: Token = Token(0);
const STATUS: Token = Token(1);
const WAKER: Token = Token(2);
const FIRST_READER: usize = 3;

/// One subscription of this process, in the waiting thread.
struct Reader {
    inbox: Arc<Mutex<Inbox>>,
    guid: Guid,
    topic: String,
    info: TypeInfo,
    /// It asks for the messages that writers offered before they were matched.
    latched: bool,
    /// A notification arrived, and the reader was not found empty since.
    ready: bool,
    /// That notification is still to be cleared.
    notified: bool,
    taken: u64,
    refused: u64,
    /// Writers that were said to be refused.
    unfit: BTreeSet<Guid>,
}

/// The participant of one node.
///
/// Dropping it informs the peers that the node leaves; a process that ends without that stays matched for up to a
/// minute.
pub struct DdsBus {
    // Fields are dropped in this order, and endpoints have to be dropped before their participant.
    services: Option<ServiceThread>,
    declared: Parameters,
    sim_time: SimTime,
    background_reader: BackgroundReader,
    writers: Vec<Writer>,
    readers: Vec<Reader>,
    inboxes: Inboxes,
    waker: Arc<Waker>,
    /// Another thread called, and no wait has returned it yet.
    called: Arc<AtomicBool>,
    signals: Option<Signals>,
    poll: Poll,
    events: Events,
    topics: BTreeMap<String, DdsTopic>,
    follower: Arc<Mutex<Follower>>,
    gate: Arc<Gate>,
    node: Arc<Mutex<ros2_client::Node>>,
    /// Endpoints were made since the node was last announced to the ROS graph.
    unannounced: bool,
    context: Context,
    participant: Participant,
    _open: OpenParticipant,
    names: Names,
    start: Instant,
}

impl DdsBus {
    /// Joins the domain as a process of the run in the environment; without one it accepts the samples of all runs.
    /// Peers are known some 0.2 s later.
    pub fn open(network: Network, names: Names) -> Result<Self, BusError> {
        Self::join(network, names, Identity::from_env(Scope::Everyone))
    }

    /// Joins the domain with this identity.
    pub fn join(network: Network, names: Names, identity: Identity) -> Result<Self, BusError> {
        Self::declaring(network, names, identity, Parameters::defaults(&[]))
    }

    /// Joins as a node with these parameters. [`Self::serve`] starts its services.
    pub(crate) fn declaring(
        network: Network,
        names: Names,
        identity: Identity,
        declared: Parameters,
    ) -> Result<Self, BusError> {
        let prefix = identity.guid_prefix();
        let gate = Arc::new(Gate::new(identity, prefix));
        let context = direct::context(network, prefix, &gate)?;
        let open = OpenParticipant::new();
        let node_error = |reason: String| BusError::Network {
            what: format!("create node {}", names.fully_qualified()),
            reason,
        };
        let name = NodeName::new(names.namespace(), names.node()).map_err(|e| node_error(e.to_string()))?;
        let mut node =
            context.new_node(name, declared.node_options()).map_err(|e| node_error(e.to_string()))?;
        node.suppress_node_info_updates(true);

        let io = |e: std::io::Error| create_error("poll", &e);
        let poll = Poll::new().map_err(io)?;
        let mut discovery = Discovery::new(&context);
        discovery.register(poll.registry(), STATUS).map_err(io)?;
        let inboxes = Inboxes::default();
        let waker = Arc::new(Waker::new(poll.registry(), WAKER).map_err(io)?);
        let follower = Arc::new(Mutex::new(Follower::new(discovery, Arc::clone(&gate), prefix)));
        let shared = (Arc::clone(&inboxes), Arc::clone(&follower), Arc::clone(&waker));
        let background_reader = BackgroundReader::spawn(shared.0, shared.1, shared.2).map_err(io)?;
        Ok(Self {
            services: None,
            declared,
            sim_time: SimTime::default(),
            background_reader,
            writers: Vec::new(),
            readers: Vec::new(),
            inboxes,
            waker,
            called: Arc::default(),
            signals: None,
            poll,
            events: Events::with_capacity(64),
            topics: BTreeMap::new(),
            follower,
            gate,
            node: Arc::new(Mutex::new(node)),
            unannounced: true,
            context,
            participant: prefix,
            _open: open,
            names,
            start: Instant::now(),
        })
    }

    /// Makes signals end a [`Bus::wait`].
    pub fn watch(&mut self, mut signals: Signals) -> Result<(), BusError> {
        self.poll
            .registry()
            .register(signals.source(), SIGNALS, Interest::READABLE)
            .map_err(|e| create_error("signal source", &e))?;
        self.signals = Some(signals);
        Ok(())
    }

    pub(crate) fn serve(&mut self) -> Result<(), BusError> {
        self.services = Some(ServiceThread::start(&self.node, self.declared.clone(), self.sim_time.clone())?);
        self.unannounced = true;
        Ok(())
    }

    /// Our participant's 12-byte GUID prefix, shared by all our writers.
    pub fn participant(&self) -> [u8; 12] {
        self.participant
    }

    /// Returns the number of messages of this publisher that some reliable reader has not acknowledged yet.
    ///
    /// Readers are those that [`Graph::identity`] counts.
    pub fn unacknowledged(&self, publisher: PublisherId) -> u64 {
        self.writers.get(publisher.0).map_or(0, |w| w.raw.unacknowledged())
    }

    /// Returns true if every matched reliable reader has also matched this publisher, so that each further message is due to it.
    pub fn is_known_to_readers(&self, publisher: PublisherId) -> bool {
        self.writers.get(publisher.0).is_none_or(|w| w.raw.is_known_to_readers())
    }

    fn dds_topic(&mut self, resolved: &str, topic: &Topic) -> Result<DdsTopic, BusError> {
        if let Some(known) = self.topics.get(resolved) {
            return Ok(known.clone());
        }
        let created = direct::topic(&self.context, wire_name(resolved), topic.info.type_name)?;
        self.topics.insert(resolved.into(), created.clone());
        Ok(created)
    }

    /// Announces the endpoints made since the last call to the ROS graph, in one message.
    fn announce(&mut self) {
        if std::mem::take(&mut self.unannounced) {
            let mut node = lock(&self.node);
            node.suppress_node_info_updates(false);
            node.suppress_node_info_updates(true);
        }
    }

    fn has_data(&self) -> bool {
        self.readers.iter().any(|r| r.ready || lock(&r.inbox).has_data())
    }

    /// Polls once. Returns the most urgent event; the others are found at the next call.
    fn poll_once(&mut self, timeout: Duration) -> Option<Wake> {
        if let Err(error) = self.poll.poll(&mut self.events, Some(timeout)) {
            // Interrupted by a signal handler: the signal's own event follows.
            if error.kind() != std::io::ErrorKind::Interrupted {
                log::error!("poll failed: {error}");
            }
            return None;
        }
        let (mut signal, mut status) = (false, false);
        for event in &self.events {
            match event.token() {
                SIGNALS => signal = true,
                STATUS => status = true,
                WAKER => {}
                Token(n) => {
                    if let Some(reader) = self.readers.get_mut(n - FIRST_READER) {
                        (reader.ready, reader.notified) = (true, true);
                    }
                }
            }
        }
        let mut follower = lock(&self.follower);
        if status {
            follower.follow();
        }
        let changed = follower.take_changed();
        drop(follower);
        if signal && self.signals.as_mut().is_some_and(Signals::drain) {
            return Some(Wake::Shutdown);
        }
        if self.has_data() {
            return Some(Wake::Data);
        }
        if changed {
            return Some(Wake::Graph);
        }
        self.called.swap(false, Ordering::AcqRel).then_some(Wake::Called)
    }
}

fn wire_name(resolved: &str) -> String {
    format!("rt{resolved}")
}

impl Bus for DdsBus {
    fn resolve(&self, topic: &Topic) -> Result<String, BusError> {
        Ok(self.names.resolve(topic.name)?)
    }

    fn advertise(&mut self, topic: &Topic) -> Result<PublisherId, BusError> {
        let resolved = self.names.resolve(topic.name)?;
        let dds_topic = self.dds_topic(&resolved, topic)?;
        let raw = RawPublisher::new(&mut lock(&self.node), &dds_topic, topic)?;
        self.unannounced = true;
        self.writers.push(Writer::new(raw, resolved, direct::window(topic)));
        Ok(PublisherId(self.writers.len() - 1))
    }

    fn subscribe(&mut self, topic: &Topic, demand: Demand) -> Result<SubscriptionId, BusError> {
        let (resolved, demand) = (self.names.resolve(topic.name)?, demand.within(topic));
        let dds_topic = self.dds_topic(&resolved, topic)?;
        let reader = RawSubscription::new(&mut lock(&self.node), &dds_topic, topic, demand)?;
        self.unannounced = true;
        let mut inbox = Inbox::new(reader, resolved.clone(), demand, self.participant());
        let index = self.readers.len();
        self.poll
            .registry()
            .register(inbox.reader.source(), Token(FIRST_READER + index), Interest::READABLE)
            .map_err(|e| create_error(&resolved, &e))?;
        let guid = inbox.reader.guid();
        self.gate.add_reader(guid, &resolved);
        let inbox = Arc::new(Mutex::new(inbox));
        lock(&self.inboxes).push(Arc::clone(&inbox));
        self.readers.push(Reader {
            inbox,
            guid,
            topic: resolved,
            info: topic.info,
            latched: demand.reliable && topic.qos.transient_local,
            ready: false,
            notified: false,
            taken: 0,
            refused: 0,
            unfit: BTreeSet::new(),
        });
        Ok(SubscriptionId(index))
    }

    fn publish_about(
        &mut self,
        publisher: PublisherId,
        body: &[u8],
        about: Option<SampleId>,
    ) -> Result<i64, BusError> {
        let writer = self.writers.get_mut(publisher.0).ok_or(BusError::Handle("publish"))?;
        let sequence = writer.write(body, about)?;
        for reader in self.readers.iter().filter(|r| r.topic == writer.topic) {
            lock(&reader.inbox).deliver_own(SampleId { writer: writer.id, sequence }, about, body);
        }
        Ok(sequence)
    }

    fn take(&mut self, subscription: SubscriptionId) -> Result<Option<Sample>, BusError> {
        self.take_fitting(subscription)
    }

    fn wait(&mut self, timeout: Duration) -> Wake {
        self.announce();
        self.background_reader.seen();
        // A caller may pass an unlimited time; a day cannot overflow.
        let timeout = timeout.min(Duration::from_secs(86_400));
        let deadline = Instant::now() + timeout;
        let at_once = self.has_data() || self.called.load(Ordering::Acquire);
        let first = if at_once { Duration::ZERO } else { timeout };
        let mut wake = self.poll_once(first);
        while wake.is_none() {
            let now = Instant::now();
            if self.has_data() {
                wake = Some(Wake::Data);
            } else if now >= deadline {
                wake = Some(Wake::Timeout);
            } else {
                wake = self.poll_once(deadline - now);
            }
        }
        self.background_reader.seen();
        wake.unwrap_or(Wake::Timeout)
    }

    fn caller(&self) -> Option<Caller> {
        let (called, waker) = (Arc::clone(&self.called), Arc::clone(&self.waker));
        Some(Caller(Arc::new(move || {
            called.store(true, Ordering::Release);
            if let Err(error) = waker.wake() {
                log::error!("cannot wake the node: {error}");
            }
        })))
    }

    fn stop_flag(&self) -> Option<Arc<AtomicBool>> {
        self.signals.as_ref().map(Signals::flag)
    }

    fn transport(&self) -> &'static str {
        "dds"
    }

    fn flush(&mut self, timeout: Duration) -> bool {
        let deadline = Instant::now() + timeout;
        // DDS may match a reader of our own, too, which acknowledges only if multicast reaches it.
        let own = |r: &Reader, topic: &str| r.topic == topic && lock(&r.inbox).demand.reliable;
        let external = |w: &&Writer| !self.readers.iter().any(|r| own(r, &w.topic));
        self.writers.iter().filter(external).all(|writer| {
            let left = deadline.saturating_duration_since(Instant::now());
            writer.raw.wait_for_acknowledgments(left)
        })
    }

    fn now(&self) -> Duration {
        self.start.elapsed()
    }

    fn node_nanos(&self) -> u64 {
        if self.declared.use_sim_time() { self.sim_time.load(Ordering::Relaxed) } else { self.wall_nanos() }
    }

    fn wall_nanos(&self) -> u64 {
        direct::wall_nanos()
    }
}

impl Graph for DdsBus {
    fn readers(&self, publisher: PublisherId) -> usize {
        self.writers
            .get(publisher.0)
            .map_or(0, |w| lock(&self.follower).graph.matches_of(w.id, |guid| self.gate.admits(guid)))
    }

    fn is_read(&self, publisher: PublisherId) -> bool {
        self.writers
            .get(publisher.0)
            .is_some_and(|w| lock(&self.follower).graph.matches_of(w.id, |_| true) > 0)
    }

    fn writers(&self, subscription: SubscriptionId) -> usize {
        let graph = &lock(&self.follower).graph;
        self.readers
            .get(subscription.0)
            .map_or(0, |r| graph.matches_of(r.guid, |guid| self.counts(graph, guid, &r.info)))
    }

    fn foreign_writers(&self, topic: &Topic) -> Vec<Guid> {
        self.writers_of(topic, |graph, guid| self.counts(graph, guid, &topic.info))
    }

    fn misfits(&self, topic: &Topic) -> Vec<Participant> {
        let misfits = |graph: &Endpoints, guid: &Guid| graph.misfit(guid, &topic.info).is_some();
        self.writers_of(topic, misfits).iter().map(Guid::participant).collect()
    }

    fn offers(&self) -> Vec<Offer> {
        lock(&self.follower).graph.offers(|guid| self.gate.admits(guid))
    }

    fn strange_offers(&self) -> Vec<Offer> {
        lock(&self.follower).graph.offers(|guid| !self.gate.admits(guid))
    }

    fn identity(&self) -> Identity {
        self.gate.identity()
    }

    fn strangers(&self) -> Vec<Stranger> {
        self.gate.strangers()
    }

    fn describe(&self, writer: Guid) -> Stranger {
        self.gate.describe(&writer.participant())
    }

    fn crowding(&self) -> Option<String> {
        crowding(&self.context).map(|sentence| format!("{sentence}: {CROWDING_ADVICE}"))
    }
}

impl Statistics for DdsBus {
    fn count_published(&mut self, publisher: PublisherId, topic: &Topic) -> Result<(), BusError> {
        let resolved = self.names.resolve(topic.name)?;
        let writer = self.writers.get_mut(publisher.0).ok_or(BusError::Handle("count_published"))?;
        writer.count_whole(resolved);
        Ok(())
    }

    fn published(&self) -> Vec<Published> {
        self.writers.iter().flat_map(Writer::published).collect()
    }

    fn received(&self) -> Vec<Received> {
        let of = |r: &Reader| {
            let refused = r.refused + lock(&r.inbox).refused;
            Received { topic: r.topic.clone(), taken: r.taken, refused }
        };
        self.readers.iter().map(of).collect()
    }

    fn announced(&self, subscription: SubscriptionId) -> Vec<Announced> {
        self.announced_to(subscription)
    }

    fn count_refused(&mut self, subscription: SubscriptionId) {
        if let Some(reader) = self.readers.get_mut(subscription.0) {
            reader.refused += 1;
        }
    }
}
