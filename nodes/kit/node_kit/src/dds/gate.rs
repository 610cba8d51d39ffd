//! Applies the rules of admission in RustDDS's threads.

use super::lock::lock;
use super::processes;
use crate::admission::{Admission, Participant, Stranger};
use crate::identity::{Identity, Scope};
use grainlab_msgs::Guid;
use ros2_client::Gid;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::Mutex;

/// The rules of admission of one bus, and the topics of its readers. RustDDS calls it for each sample.
#[derive(Debug)]
pub(super) struct Gate {
    identity: Identity,
    admission: Mutex<Admission>,
    /// The resolved topic of each of our readers.
    topics: Mutex<BTreeMap<[u8; 16], String>>,
}

fn prefix(guid: &Gid) -> Participant {
    Guid(guid.to_bytes16()).participant()
}

impl Gate {
    pub(super) fn new(identity: Identity, own: Participant) -> Self {
        Self { identity, admission: Mutex::new(Admission::new(identity, own)), topics: Mutex::default() }
    }

    pub(super) fn identity(&self) -> Identity {
        self.identity
    }

    /// Registers one of our readers under its topic.
    pub(super) fn add_reader(&self, reader: Gid, topic: &str) {
        lock(&self.topics).insert(reader.to_bytes16(), topic.to_owned());
    }

    /// Removes one of our readers.
    pub(super) fn remove_reader(&self, reader: Gid) {
        lock(&self.topics).remove(&reader.to_bytes16());
    }

    /// Whether one of our readers accepts a sample of this writer.
    pub(super) fn takes(&self, writer: Gid, reader: Gid) -> bool {
        let mut admission = lock(&self.admission);
        if admission.admits(&prefix(&writer)) {
            return true;
        }
        // A reader without a topic is that of a service: anyone may ask.
        let Some(topic) = lock(&self.topics).get(&reader.to_bytes16()).cloned() else { return true };
        let (taken, new) = admission.takes(Guid(writer.to_bytes16()), &topic);
        if new {
            let stranger = admission.describe(&prefix(&writer));
            drop(admission);
            log::info!("{topic}: {stranger} is not of this run: its samples are ignored");
        }
        taken
    }

    /// Whether endpoints of this participant count.
    pub(super) fn admits(&self, guid: &Gid) -> bool {
        lock(&self.admission).admits(&prefix(guid))
    }

    /// The same by its GUID prefix.
    pub(super) fn admits_prefix(&self, prefix: &[u8]) -> bool {
        <&Participant>::try_from(prefix).is_ok_and(|prefix| lock(&self.admission).admits(prefix))
    }

    /// Records a discovered participant and its addresses.
    pub(super) fn discovered(&self, participant: Gid, addresses: &[SocketAddr]) {
        let participant = prefix(&participant);
        // The process of a participant is looked up only where admission or a message needs it.
        let ours = self.identity.run.is_some() && lock(&self.admission).admits(&participant);
        if self.identity.scope == Scope::Everyone || ours {
            return;
        }
        if let Some(process) = processes::listening_on(addresses, self.identity.root) {
            lock(&self.admission).discovered(participant, process);
        }
    }

    /// Removes a participant that left.
    pub(super) fn lost(&self, participant: &Participant) {
        lock(&self.admission).lost(participant);
    }

    pub(super) fn strangers(&self) -> Vec<Stranger> {
        lock(&self.admission).strangers()
    }

    pub(super) fn describe(&self, participant: &Participant) -> Stranger {
        lock(&self.admission).describe(participant)
    }
}
