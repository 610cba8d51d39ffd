//! The publishers of a playback.

use grainlab_console::Failure;
use grainlab_msgs::{Topic, topics};
use grainlab_node_kit::{BulkPublisher, Bus, BusError, DdsBus, PublisherId, Wake};
use std::collections::BTreeMap;
use std::time::Duration;

/// Time for all subscriptions to be discovered after the first.
const SETTLE: Duration = Duration::from_millis(1000);

/// The publisher of one topic.
pub(super) enum Outlet {
    Plain(PublisherId),
    /// Packings of any length: large ones in parts.
    Bulk(Box<BulkPublisher>),
}

impl Outlet {
    pub(super) fn id(&self) -> PublisherId {
        match self {
            Self::Plain(id) => *id,
            Self::Bulk(bulk) => bulk.id(),
        }
    }

    pub(super) fn publish(&mut self, bus: &mut DdsBus, body: &[u8]) -> Result<(), BusError> {
        match self {
            Self::Plain(id) => bus.publish(*id, body).map(|_| ()),
            Self::Bulk(bulk) => bulk.publish(bus, body),
        }
    }

    /// Sends parts of a large message; true if none is in transit.
    pub(super) fn advance(&mut self, bus: &mut DdsBus) -> Result<bool, Failure> {
        match self {
            Self::Plain(_) => Ok(true),
            Self::Bulk(bulk) => bulk.advance(bus).map_err(Failure::failed),
        }
    }
}

pub(super) type Outlets = BTreeMap<String, Outlet>;

/// Advertises the recorded topic `name` as `to`; the inner error is the reason if it is not
/// possible.
pub(super) fn offer(bus: &mut DdsBus, name: &str, to: &str) -> Result<Result<Outlet, String>, Failure> {
    let Some(row) = Topic::by_name(name) else {
        return Ok(Err("its type is not one of the laboratory".to_owned()));
    };
    // The names of topics are static; these are few.
    let topic = Topic { name: Box::leak(to.to_owned().into_boxed_str()), ..*row };
    let writers = bus.foreign_writers(&topic);
    if let Some(writer) = writers.first() {
        return Ok(Err(format!("a live node publishes it (writer {writer})")));
    }
    let outlet = if topic.info == topics::PACKING.info {
        BulkPublisher::advertise(bus, &topic).map(|bulk| Outlet::Bulk(Box::new(bulk)))
    } else {
        bus.advertise(&topic).map(Outlet::Plain)
    };
    Ok(Ok(outlet.map_err(Failure::failed)?))
}

/// Follows the graph for `time`.
pub(super) fn pause(bus: &mut DdsBus, time: Duration) {
    let end = bus.now() + time;
    while let Some(left) = end.checked_sub(bus.now()).filter(|left| !left.is_zero()) {
        bus.wait(left);
    }
}

/// Waits until every topic has the readers it needs and no more appear for a short time; false on a signal.
pub(super) fn wait_for_readers(
    bus: &mut DdsBus,
    publishers: &Outlets,
    needed: usize,
    patience: Duration,
) -> bool {
    let end = bus.now() + patience;
    let count = |bus: &DdsBus| publishers.values().map(|p| bus.readers(p.id())).collect::<Vec<_>>();
    let (mut known, mut since) = (count(bus), bus.now());
    loop {
        let now = bus.now();
        let counts = count(bus);
        if counts != known {
            (known, since) = (counts, now);
        }
        let complete = known.iter().all(|n| *n >= needed) && now - since >= SETTLE;
        if complete || now >= end {
            let lonely = publishers.keys().zip(&known).filter(|(_, n)| **n < needed);
            let lonely: Vec<&str> = lonely.map(|(name, _)| name.as_str()).collect();
            if !lonely.is_empty() && !patience.is_zero() {
                grainlab_console::say!("grainlab: fewer than {needed} subscribers of {}", lonely.join(", "));
            }
            return true;
        }
        if bus.wait(Duration::from_millis(100)) == Wake::Shutdown {
            return false;
        }
    }
}
