//! The endpoints of other processes and their matches, followed through the participant's event channel.
//!
//! The endpoints' own status channels hold four events and drop the rest; the participant's holds 2048.

use crate::sample::WriterId;
use rustdds::{DomainParticipantStatusEvent as Event, GUID};
use std::collections::{BTreeMap, BTreeSet};

/// Endpoints of other processes, and the matches of those of this process.
#[derive(Default)]
pub(super) struct Graph {
    own: [u8; 12],
    /// Remote writers by DDS topic name.
    writers: BTreeMap<GUID, String>,
    /// Local endpoint to matched remote endpoints.
    matches: BTreeMap<GUID, BTreeSet<GUID>>,
}

fn prefix(guid: &GUID) -> [u8; 12] {
    WriterId(guid.to_bytes()).participant()
}

impl Graph {
    pub(super) fn new(participant: GUID) -> Self {
        Self { own: prefix(&participant), ..Self::default() }
    }

    /// Processes one event; true if it changed the graph.
    pub(super) fn apply(&mut self, event: Event) -> bool {
        match event {
            Event::WriterDetected { writer } => {
                !self.is_ours(&writer.guid) && self.writers.insert(writer.guid, writer.topic_name).is_none()
            }
            Event::RemoteReaderMatched { local_writer, remote_reader } => {
                self.matched(local_writer, remote_reader)
            }
            Event::RemoteWriterMatched { local_reader, remote_writer } => {
                self.matched(local_reader, remote_writer)
            }
            Event::WriterLost { guid, .. } | Event::ReaderLost { guid, .. } => self.lost(|g| *g == guid),
            Event::ParticipantLost { id, .. } => self.lost(|g| g.prefix == id),
            Event::RemoteReaderQosIncompatible { remote_reader, requested_qos, offered_qos, .. } => {
                log::warn!(
                    "a reader ({}) requests more than this process offers and receives nothing: requested {requested_qos:?}, offered {offered_qos:?}",
                    WriterId(remote_reader.to_bytes())
                );
                false
            }
            Event::RemoteWriterQosIncompatible { remote_writer, requested_qos, offered_qos, .. } => {
                log::warn!(
                    "a writer ({}) offers less than this process requests, so that its samples are not received: requested {requested_qos:?}, offered {offered_qos:?}",
                    WriterId(remote_writer.to_bytes())
                );
                false
            }
            Event::InconsistentTopic { previous_topic_data, discovered_topic_data, .. } => {
                log::warn!(
                    "a peer uses a topic of this process with another type: {previous_topic_data:?} and {discovered_topic_data:?}"
                );
                false
            }
            _ => false,
        }
    }

    fn is_ours(&self, guid: &GUID) -> bool {
        prefix(guid) == self.own
    }

    /// A participant also matches itself; that does not count as a peer.
    fn matched(&mut self, local: GUID, remote: GUID) -> bool {
        !self.is_ours(&remote) && self.matches.entry(local).or_default().insert(remote)
    }

    fn lost(&mut self, gone: impl Fn(&GUID) -> bool) -> bool {
        let before = self.writers.len() + self.matches.values().map(BTreeSet::len).sum::<usize>();
        self.writers.retain(|guid, _| !gone(guid));
        for remotes in self.matches.values_mut() {
            remotes.retain(|guid| !gone(guid));
        }
        before != self.writers.len() + self.matches.values().map(BTreeSet::len).sum::<usize>()
    }

    /// Remote endpoints matched with a local one, of those that count.
    pub(super) fn matches_of(&self, local: GUID, counts: impl Fn(&GUID) -> bool) -> usize {
        self.matches.get(&local).map_or(0, |remotes| remotes.iter().filter(|guid| counts(guid)).count())
    }

    /// Remote writers of a DDS topic name, sorted, of those that count.
    pub(super) fn writers_of(&self, dds_topic: &str, counts: impl Fn(&GUID) -> bool) -> Vec<WriterId> {
        self.writers
            .iter()
            .filter(|(guid, topic)| *topic == dds_topic && counts(guid))
            .map(|(g, _)| WriterId(g.to_bytes()))
            .collect()
    }
}
