//! The endpoints of other processes and their matches, as discovery reports them.

use super::direct::{Change, Discovery};
use super::gate::Gate;
use crate::admission::Participant;
use crate::offer::Offer;
use grainlab_msgs::{Guid, TypeInfo};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Keeps the graph up to date. The queue of changes drops what does not fit, so the background reader empties it while the node
/// computes: many programs may come and go meanwhile.
pub(super) struct Follower {
    discovery: Discovery,
    gate: Arc<Gate>,
    pub(super) graph: Endpoints,
    /// The graph changed, and no wait has returned it yet.
    changed: bool,
}

impl Follower {
    pub(super) fn new(discovery: Discovery, gate: Arc<Gate>, own: Participant) -> Self {
        Self { discovery, gate, graph: Endpoints { own, ..Endpoints::default() }, changed: false }
    }

    /// Processes the queued changes; true if one changed the graph.
    pub(super) fn follow(&mut self) -> bool {
        let mut changed = false;
        while let Some(change) = self.discovery.next() {
            if let Change::ParticipantLost(participant) = &change {
                self.gate.lost(participant);
            }
            changed |= self.graph.apply(change);
        }
        self.changed |= changed;
        changed
    }

    pub(super) fn take_changed(&mut self) -> bool {
        std::mem::take(&mut self.changed)
    }
}

/// Endpoints of other processes, and the matches of those of this process.
#[derive(Default)]
pub(super) struct Endpoints {
    own: Participant,
    /// Remote writers: their DDS topic, and what they offer there.
    writers: BTreeMap<Guid, (String, Option<Offer>)>,
    /// Local endpoint to matched remote endpoints.
    matches: BTreeMap<Guid, BTreeSet<Guid>>,
}

impl Endpoints {
    /// Processes one change; true if it changed the graph.
    fn apply(&mut self, change: Change) -> bool {
        match change {
            Change::Writer { writer, topic, offer } => {
                !self.is_ours(&writer) && self.writers.insert(writer, (topic, offer)).is_none()
            }
            Change::Matched { local, remote } => self.matched(local, remote),
            Change::Lost(gid) => self.lost(|g| *g == gid),
            Change::ParticipantLost(participant) => self.lost(|g| g.participant() == participant),
            Change::Misfit(what) => {
                log::warn!("{what}");
                false
            }
            Change::Other => false,
        }
    }

    fn is_ours(&self, guid: &Guid) -> bool {
        guid.participant() == self.own
    }

    /// A participant also matches itself; that does not count as a peer.
    fn matched(&mut self, local: Guid, remote: Guid) -> bool {
        !self.is_ours(&remote) && self.matches.entry(local).or_default().insert(remote)
    }

    fn lost(&mut self, gone: impl Fn(&Guid) -> bool) -> bool {
        let before = self.writers.len() + self.matches.values().map(BTreeSet::len).sum::<usize>();
        self.writers.retain(|guid, _| !gone(guid));
        for remotes in self.matches.values_mut() {
            remotes.retain(|guid| !gone(guid));
        }
        before != self.writers.len() + self.matches.values().map(BTreeSet::len).sum::<usize>()
    }

    /// Remote endpoints matched with a local one, of those that count.
    pub(super) fn matches_of(&self, local: Guid, counts: impl Fn(&Guid) -> bool) -> usize {
        self.matches.get(&local).map_or(0, |remotes| remotes.iter().filter(|guid| counts(guid)).count())
    }

    /// Remote writers of a DDS topic name, sorted, of those that count.
    pub(super) fn writers_of(&self, dds_topic: &str, counts: impl Fn(&Guid) -> bool) -> Vec<Guid> {
        self.writers
            .iter()
            .filter(|(guid, (topic, _))| topic == dds_topic && counts(guid))
            .map(|(guid, _)| *guid)
            .collect()
    }

    pub(super) fn misfit(&self, writer: &Guid, info: &TypeInfo) -> Option<String> {
        let (_, offer) = self.writers.get(writer)?;
        offer.as_ref()?.misfit(info)
    }

    /// Offers of remote writers, in the order of topics, of those that count.
    pub(super) fn offers(&self, counts: impl Fn(&Guid) -> bool) -> Vec<Offer> {
        let counted = self.writers.iter().filter(|(guid, _)| counts(guid));
        let mut offers: Vec<Offer> = counted.filter_map(|(_, (_, offer))| offer.clone()).collect();
        offers.sort_by(|a, b| (&a.topic, a.writer).cmp(&(&b.topic, b.writer)));
        offers
    }
}
