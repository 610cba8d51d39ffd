//! Which writers fit a subscription: messages of another type, or of another definition of the type, are not read by position.

use super::{DdsBus, wire_name};
use crate::admission::Participant;
use crate::bus::SubscriptionId;
use crate::bus_error::BusError;
use crate::dds::lock::lock;
use crate::sample::Sample;
use grainlab_msgs::{Guid, Topic, TypeInfo};
use ros2_client::Gid;

impl DdsBus {
    /// Whether a remote writer counts for a reader of this type: it is admitted, and its messages are read.
    pub(super) fn counts(&self, writer: &Gid, info: &TypeInfo) -> bool {
        self.gate.admits(writer) && self.graph.misfit(&Guid(writer.to_bytes16()), info).is_none()
    }

    /// The next sample whose writer fits the type of the subscription; others are counted and said once.
    pub(super) fn take_fitting(&mut self, subscription: SubscriptionId) -> Result<Option<Sample>, BusError> {
        self.background_reader.seen();
        // A writer is known before its first sample, but perhaps not here yet.
        self.changed |= self.follow_graph();
        let subscriber = self.subscribers.get_mut(subscription.0).ok_or(BusError::Handle("take"))?;
        let reader = self.readers.get_mut(subscriber.reader).ok_or(BusError::Handle("take"))?;
        let mut inbox = lock(&reader.inbox);
        if std::mem::take(&mut reader.notified) {
            inbox.acknowledge();
        }
        let mut sample = inbox.take(subscriber.place)?;
        while let Some((writer, why)) = sample
            .as_ref()
            .and_then(|s| Some((s.info.writer, self.graph.misfit(&s.info.writer, &reader.info)?)))
        {
            subscriber.refused += 1;
            if self.refused.insert((writer, subscription.0)) {
                let (who, known) = (self.gate.describe(&writer.participant()), reader.info.type_name);
                log::error!(
                    "{}: {who}: {why}, not the {known} of this program: its messages are not read. Use one version of \
                     grainlab and of its message files on both sides",
                    reader.topic
                );
            }
            sample = inbox.take(subscriber.place)?;
        }
        match sample {
            Some(_) => subscriber.taken += 1,
            None => reader.ready = false,
        }
        Ok(sample)
    }

    /// The participants with a writer on a topic that does not fit.
    pub(super) fn misfits_on(&self, topic: &Topic) -> Vec<Participant> {
        let Ok(name) = self.names.resolve(topic.name) else { return Vec::new() };
        let misfits = |guid: &Gid| self.graph.misfit(&Guid(guid.to_bytes16()), &topic.info).is_some();
        let found = self.graph.writers_of(&wire_name(&name), misfits);
        found.iter().map(Guid::participant).collect()
    }
}
