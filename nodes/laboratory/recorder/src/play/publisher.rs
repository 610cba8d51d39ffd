//! The publishers of a playback.

use super::watch::{Seen, Watch};
use grainlab_console::{Failure, say};
use grainlab_msgs::{Topic, topics};
use grainlab_node_kit::{BulkPublisher, Bus, BusError, DdsBus, Graph, PublisherId, Wake};
use grainlab_recordings::{ChannelInfo, QosOverrides, offered_profiles};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// Time for all subscriptions to be discovered after the first.
const SETTLE: Duration = Duration::from_millis(1000);

pub(super) struct TopicPublisher {
    /// Name on the bus, behind a remap.
    name: String,
    id: PublisherId,
    /// Packings of any length: large ones in parts.
    bulk: Option<BulkPublisher>,
    sent: u64,
    watch: Watch,
}

impl TopicPublisher {
    pub(super) fn publish(&mut self, bus: &mut DdsBus, body: &[u8]) -> Result<(), BusError> {
        match &mut self.bulk {
            None => bus.publish(self.id, body).map(|_| ()),
            Some(bulk) => bulk.publish(bus, body),
        }?;
        self.sent += 1;
        Ok(())
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn sent(&self) -> u64 {
        self.sent
    }

    pub(super) fn look(&mut self, bus: &DdsBus) {
        let seen = Seen {
            sent: self.sent,
            pending: bus.unacknowledged(self.id),
            readers: bus.readers(self.id),
            is_answered: bus.is_known_to_readers(self.id),
        };
        self.watch.look(bus.now(), seen);
    }

    pub(super) fn watch(&self) -> &Watch {
        &self.watch
    }

    /// Number of large messages that a subscriber did not receive.
    pub(super) fn left_behind(&self) -> u64 {
        self.bulk.as_ref().map_or(0, BulkPublisher::left_behind)
    }

    /// Sends parts of a large message; true if none is in transit.
    pub(super) fn advance(&mut self, bus: &mut DdsBus) -> Result<bool, Failure> {
        self.bulk.as_mut().map_or(Ok(true), |bulk| bulk.advance(bus).map_err(Failure::failed))
    }
}

pub(super) type TopicPublishers = BTreeMap<String, TopicPublisher>;

/// Advertises a recorded topic as `to`; the inner error is the reason if it is not possible.
pub(super) fn offer(
    bus: &mut DdsBus,
    channel: &ChannelInfo,
    to: &str,
    overrides: &QosOverrides,
) -> Result<Result<TopicPublisher, String>, Failure> {
    if channel.message_encoding != "cdr" {
        return Ok(Err(format!("its messages are {:?}, not CDR", channel.message_encoding)));
    }
    let (recorded, differ) = offered_profiles(&channel.qos);
    // Topics of the laboratory have their own, whatever a program between wrote into the recording.
    let row = Topic::by_name(&channel.topic).filter(|row| row.info.type_name == channel.ros_type);
    let qos = overrides.apply(&channel.topic, row.map_or(recorded, |row| row.qos));
    let Some(topic) = Topic::outside_contract(to, &channel.ros_type, qos) else {
        return Ok(Err(format!("its type {:?} is not written as package/msg/Type", channel.ros_type)));
    };
    if row.is_none() && differ {
        say!("grainlab: {}: its publishers had different QoS; it is offered {qos}", channel.topic);
    }
    let writers = bus.foreign_writers(&topic);
    if let Some(writer) = writers.first() {
        return Ok(Err(format!("a live node publishes {to} (writer {writer})")));
    }
    let name = to.to_owned();
    let publisher = if topic.info == topics::PACKING.info {
        BulkPublisher::advertise(bus, &topic).map(|bulk| TopicPublisher {
            name,
            id: bulk.id(),
            bulk: Some(bulk),
            sent: 0,
            watch: Watch::default(),
        })
    } else {
        bus.advertise(&topic).map(|id| TopicPublisher {
            name,
            id,
            bulk: None,
            sent: 0,
            watch: Watch::default(),
        })
    };
    match publisher {
        Err(BusError::Name(error)) => Ok(Err(error.to_string())),
        publisher => Ok(Ok(publisher.map_err(Failure::failed)?)),
    }
}

/// Follows the graph for `time`.
pub(super) fn pause(bus: &mut DdsBus, time: Duration) {
    let end = bus.now() + time;
    while let Some(left) = end.checked_sub(bus.now()).filter(|left| !left.is_zero()) {
        bus.wait(left);
    }
}

/// Waits until every topic has the readers it needs, these know its publisher, and no more appear for a short time; false on a
/// signal.
pub(super) fn wait_for_readers(
    bus: &mut DdsBus,
    publishers: &mut TopicPublishers,
    needed: usize,
    patience: Duration,
) -> bool {
    let end = bus.now() + patience;
    let (mut known, mut since) = (Vec::new(), bus.now());
    loop {
        let now = bus.now();
        // A subscriber that does not answer is noticed although nothing is sent yet.
        publishers.values_mut().for_each(|publisher| publisher.look(bus));
        let counts: Vec<usize> = publishers.values().map(|p| bus.readers(p.id)).collect();
        if counts != known {
            (known, since) = (counts, now);
        }
        let is_known = || publishers.values().all(|p| bus.is_known_to_readers(p.id));
        let complete = known.iter().all(|n| *n >= needed) && now - since >= SETTLE && is_known();
        if complete || now >= end {
            let lonely = publishers.values().zip(&known).filter(|(_, n)| **n < needed);
            let lonely: BTreeSet<&str> = lonely.map(|(publisher, _)| publisher.name.as_str()).collect();
            if !lonely.is_empty() && !patience.is_zero() {
                let names = Vec::from_iter(lonely).join(", ");
                say!("grainlab: fewer than {needed} subscribers of {names}");
            }
            return true;
        }
        if bus.wait(Duration::from_millis(100)) == Wake::Shutdown {
            return false;
        }
    }
}
