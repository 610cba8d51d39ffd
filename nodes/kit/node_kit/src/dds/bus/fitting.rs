//! Writers that fit a subscription: messages of another type, or of another definition of the type, are not read by position.

use super::{DdsBus, wire_name};
use crate::announced::Announced;
use crate::bus_error::BusError;
use crate::dds::graph::Endpoints;
use crate::handles::SubscriptionId;
use crate::lock::lock;
use crate::sample::Sample;
use grainlab_msgs::{Guid, Topic, TypeInfo};

impl DdsBus {
    /// True if a remote writer counts for a reader of this type: it is admitted, and its messages are read.
    pub(super) fn counts(&self, graph: &Endpoints, writer: &Guid, info: &TypeInfo) -> bool {
        self.gate.admits(writer) && graph.misfit(writer, info).is_none()
    }

    /// The next sample whose writer fits the type of the subscription; others are counted and said once.
    pub(super) fn take_fitting(&mut self, subscription: SubscriptionId) -> Result<Option<Sample>, BusError> {
        self.background_reader.seen();
        // A writer is known before its first sample, but perhaps not here yet.
        let mut follower = lock(&self.follower);
        follower.follow();
        let reader = self.readers.get_mut(subscription.0).ok_or(BusError::Handle("take"))?;
        let mut inbox = lock(&reader.inbox);
        if std::mem::take(&mut reader.notified) {
            inbox.reader.acknowledge();
        }
        let mut sample = inbox.take()?;
        while let Some((writer, why)) = sample
            .as_ref()
            .and_then(|s| Some((s.info.writer, follower.graph.misfit(&s.info.writer, &reader.info)?)))
        {
            reader.refused += 1;
            if reader.unfit.insert(writer) {
                let (who, known) = (self.gate.describe(&writer.participant()), reader.info.type_name);
                log::error!(
                    "{}: {who}: {why}, not the {known} of this program: its messages are not read. Use one version of \
                     grainlab and of its message files on both sides",
                    reader.topic
                );
            }
            sample = inbox.take()?;
        }
        match sample {
            Some(_) => reader.taken += 1,
            None => reader.ready = false,
        }
        Ok(sample)
    }

    /// Writers of other processes on a topic, sorted, of those that count.
    pub(super) fn writers_of(&self, topic: &Topic, counts: impl Fn(&Endpoints, &Guid) -> bool) -> Vec<Guid> {
        let Ok(name) = self.names.resolve(topic.name) else { return Vec::new() };
        let graph = &lock(&self.follower).graph;
        graph.writers_of(&wire_name(&name), |guid| counts(graph, guid))
    }

    /// Returns what writers announced to a subscription, without the writers whose samples do not fit its type.
    pub(super) fn announced_to(&self, subscription: SubscriptionId) -> Vec<Announced> {
        let Some(reader) = self.readers.get(subscription.0) else { return Vec::new() };
        let mut all = self.gate.announced(reader.guid, reader.latched);
        let graph = &lock(&self.follower).graph;
        let is_refused =
            |writer: &Guid| reader.unfit.contains(writer) || graph.misfit(writer, &reader.info).is_some();
        all.retain(|announced| !is_refused(&announced.writer));
        all
    }
}
