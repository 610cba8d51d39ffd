//! The endpoints of other processes and their matches, as discovery reports them.

use super::direct::Change;
use crate::offer::{Misfit, Offer};
use grainlab_msgs::{Guid, TypeInfo};
use ros2_client::Gid;
use std::collections::{BTreeMap, BTreeSet};

/// Endpoints of other processes, and the matches of those of this process.
#[derive(Default)]
pub(super) struct Graph {
    own: [u8; 12],
    /// Remote writers: their DDS topic, and what they offer there.
    writers: BTreeMap<Gid, (String, Option<Offer>)>,
    /// Local endpoint to matched remote endpoints.
    matches: BTreeMap<Gid, BTreeSet<Gid>>,
}

fn prefix(guid: &Gid) -> [u8; 12] {
    Guid(guid.to_bytes16()).participant()
}

impl Graph {
    pub(super) fn new(participant: Gid) -> Self {
        Self { own: prefix(&participant), ..Self::default() }
    }

    /// Processes one change; true if it changed the graph.
    pub(super) fn apply(&mut self, change: Change) -> bool {
        match change {
            Change::Writer { writer, topic, offer } => {
                !self.is_ours(&writer) && self.writers.insert(writer, (topic, offer)).is_none()
            }
            Change::Matched { local, remote } => self.matched(local, remote),
            Change::Lost(gid) => self.lost(|g| *g == gid),
            Change::ParticipantLost(participant) => self.lost(|g| prefix(g) == participant),
            Change::Misfit(what) => {
                log::warn!("{what}");
                false
            }
            Change::Other => false,
        }
    }

    fn is_ours(&self, guid: &Gid) -> bool {
        prefix(guid) == self.own
    }

    /// A participant also matches itself; that does not count as a peer.
    fn matched(&mut self, local: Gid, remote: Gid) -> bool {
        !self.is_ours(&remote) && self.matches.entry(local).or_default().insert(remote)
    }

    fn lost(&mut self, gone: impl Fn(&Gid) -> bool) -> bool {
        let before = self.writers.len() + self.matches.values().map(BTreeSet::len).sum::<usize>();
        self.writers.retain(|guid, _| !gone(guid));
        for remotes in self.matches.values_mut() {
            remotes.retain(|guid| !gone(guid));
        }
        before != self.writers.len() + self.matches.values().map(BTreeSet::len).sum::<usize>()
    }

    /// Remote endpoints matched with a local one, of those that count.
    pub(super) fn matches_of(&self, local: Gid, counts: impl Fn(&Gid) -> bool) -> usize {
        self.matches.get(&local).map_or(0, |remotes| remotes.iter().filter(|guid| counts(guid)).count())
    }

    /// Remote writers of a DDS topic name, sorted, of those that count.
    pub(super) fn writers_of(&self, dds_topic: &str, counts: impl Fn(&Gid) -> bool) -> Vec<Guid> {
        self.writers
            .iter()
            .filter(|(guid, (topic, _))| topic == dds_topic && counts(guid))
            .map(|(g, _)| Guid(g.to_bytes16()))
            .collect()
    }

    /// Why the messages of a writer must not be read as those of a type.
    pub(super) fn misfit(&self, writer: &Guid, info: &TypeInfo) -> Option<Misfit> {
        let (_, offer) = self.writers.get(&Gid::from(writer.0))?;
        offer.as_ref()?.misfit(info)
    }

    /// What remote writers offer, in the order of topics, of those that count.
    pub(super) fn offers(&self, counts: impl Fn(&Gid) -> bool) -> Vec<Offer> {
        let counted = self.writers.iter().filter(|(guid, _)| counts(guid));
        let mut offers: Vec<Offer> = counted.filter_map(|(_, (_, offer))| offer.clone()).collect();
        offers.sort_by(|a, b| (&a.topic, a.writer).cmp(&(&b.topic, b.writer)));
        offers
    }
}
