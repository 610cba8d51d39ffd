//! Applies the rules of admission in RustDDS's threads.

use super::announcements::Announcements;
use crate::admission::{Admission, Participant, Process, Stranger};
use crate::announced::Announced;
use crate::identity::{Identity, Scope};
use crate::lock::lock;
use crate::processes;
use grainlab_msgs::Guid;
use rustdds::ReceptionEvent;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::Mutex;

/// The rules of admission of one bus, and the topics of its readers. RustDDS calls it for each sample.
#[derive(Debug)]
pub(super) struct Gate {
    identity: Identity,
    admission: Mutex<Admission>,
    /// The resolved topic of each of our readers.
    topics: Mutex<BTreeMap<Guid, String>>,
    announcements: Mutex<Announcements>,
}

impl Gate {
    pub(super) fn new(identity: Identity, own: Participant) -> Self {
        Self {
            identity,
            admission: Mutex::new(Admission::new(identity, own)),
            topics: Mutex::default(),
            announcements: Mutex::default(),
        }
    }

    pub(super) fn identity(&self) -> Identity {
        self.identity
    }

    pub(super) fn add_reader(&self, reader: Guid, topic: &str) {
        lock(&self.topics).insert(reader, topic.to_owned());
    }

    /// Keeps what one of our readers learnt of an admitted writer of another process. Warns of messages that are too large.
    pub(super) fn learnt(&self, writer: Guid, reader: Guid, event: ReceptionEvent) {
        let participant = writer.participant();
        if participant == reader.participant() || !self.admits(&writer) {
            return;
        }
        // A reader without a topic belongs to a service.
        let Some(topic) = lock(&self.topics).get(&reader).cloned() else { return };
        let too_large = lock(&self.announcements).enter(writer, reader, event);
        if let (Some(all), ReceptionEvent::TooLarge { size, limit, .. }) = (too_large, event)
            && all.count.is_power_of_two()
        {
            let who = self.describe(&participant);
            log::warn!(
                "{topic}: a message of {who} with {size} bytes is not received, because the limit is {limit} bytes ({} so far). \
                 Send it in parts",
                all.count
            );
        }
    }

    pub(super) fn announced(&self, reader: Guid, latched: bool) -> Vec<Announced> {
        lock(&self.announcements).of(&reader, latched)
    }

    pub(super) fn takes(&self, writer: Guid, reader: Guid) -> bool {
        let mut admission = lock(&self.admission);
        if admission.admits(&writer.participant()) {
            return true;
        }
        // A reader without a topic is that of a service: anyone may ask.
        let Some(topic) = lock(&self.topics).get(&reader).cloned() else { return true };
        let (taken, new) = admission.takes(writer, &topic);
        if new {
            let stranger = admission.describe(&writer.participant());
            drop(admission);
            log::info!("{topic}: {stranger} is not of this run: its samples are ignored");
        }
        taken
    }

    pub(super) fn admits(&self, guid: &Guid) -> bool {
        lock(&self.admission).admits(&guid.participant())
    }

    pub(super) fn admits_prefix(&self, prefix: &[u8]) -> bool {
        <&Participant>::try_from(prefix).is_ok_and(|prefix| lock(&self.admission).admits(prefix))
    }

    /// Records a discovered participant and its addresses. True if discovery keeps room for it, however many others there are.
    pub(super) fn discovered(&self, participant: Guid, addresses: &[SocketAddr]) -> bool {
        let participant = participant.participant();
        self.look_up(participant, addresses);
        lock(&self.admission).counts_on(&participant)
    }

    fn look_up(&self, participant: Participant, addresses: &[SocketAddr]) {
        // The process of a participant is looked up only where admission or a message needs it.
        let ours = self.identity.run.is_some() && lock(&self.admission).admits(&participant);
        // A launcher starts its processes as its own user: the run and a member number alone can be taken by anyone.
        let pretends = ours && self.identity.member != 0 && processes::of_another_user(addresses);
        if self.identity.scope == Scope::Everyone || (ours && !pretends) {
            return;
        }
        let process = processes::listening_on(addresses, self.identity.root);
        if let Some(process) = process.or_else(|| pretends.then(Process::default)) {
            lock(&self.admission).discovered(participant, process);
        }
    }

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
