//! One participant of the network in memory.

use super::state::{MemoryState, Reader, Writer};
use crate::BULK_LIMIT;
use crate::admission::{Admission, Participant, Stranger};
use crate::announced::Announced;
use crate::bus::{Bus, Caller, Wake};
use crate::bus_error::BusError;
use crate::demand::Demand;
use crate::graph::Graph;
use crate::handles::{PublisherId, SubscriptionId};
use crate::identity::Identity;
use crate::names::Names;
use crate::offer::Offer;
use crate::sample::{Sample, SampleId};
use crate::statistics::Statistics;
use grainlab_msgs::{Guid, Published, Received, Topic};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// A bus of a [`crate::Hub`]. Waiting advances virtual time.
#[derive(Debug)]
pub struct MemoryBus {
    state: Rc<RefCell<MemoryState>>,
    participant: Participant,
    admission: Admission,
    names: Names,
    /// Indices in the hub.
    writers: Vec<usize>,
    readers: Vec<usize>,
    /// Number of messages that a writer, by its index in the hub, sent in parts.
    wholes: BTreeMap<(usize, String), u64>,
    interrupted: bool,
}

impl MemoryBus {
    pub(super) fn new(
        state: Rc<RefCell<MemoryState>>,
        participant: Participant,
        names: Names,
        identity: Identity,
    ) -> Self {
        let admission = Admission::new(identity, participant);
        let (writers, readers, wholes) = (Vec::new(), Vec::new(), BTreeMap::new());
        Self { state, participant, admission, names, writers, readers, wholes, interrupted: false }
    }

    /// Acts as a signal on the real bus: the next wait returns [`Wake::Shutdown`], once.
    pub fn interrupt(&mut self) {
        self.interrupted = true;
    }

    /// True if a sample can be taken now.
    pub fn has_data(&self) -> bool {
        let state = self.state.borrow();
        let now = state.time.transit;
        self.readers.iter().any(|r| state.readers[*r].has_data(now))
    }

    /// True for an admitted writer of another process.
    fn counts(&self, writer: Guid) -> bool {
        let participant = writer.participant();
        participant != self.participant && self.admission.admits(&participant)
    }
}

impl Bus for MemoryBus {
    fn resolve(&self, topic: &Topic) -> Result<String, BusError> {
        Ok(self.names.resolve(topic.name)?)
    }

    fn advertise(&mut self, topic: &Topic) -> Result<PublisherId, BusError> {
        let resolved = self.names.resolve(topic.name)?;
        self.writers.push(self.state.borrow_mut().add_writer(self.participant, resolved, topic));
        Ok(PublisherId(self.writers.len() - 1))
    }

    fn subscribe(&mut self, topic: &Topic, demand: Demand) -> Result<SubscriptionId, BusError> {
        let resolved = self.names.resolve(topic.name)?;
        let demand = demand.within(topic);
        let mut state = self.state.borrow_mut();
        self.readers.push(state.add_reader(self.participant, resolved, demand));
        Ok(SubscriptionId(self.readers.len() - 1))
    }

    fn publish_about(
        &mut self,
        publisher: PublisherId,
        body: &[u8],
        about: Option<SampleId>,
    ) -> Result<i64, BusError> {
        let writer = *self.writers.get(publisher.0).ok_or(BusError::Handle("publish"))?;
        let mut state = self.state.borrow_mut();
        if !(body.starts_with(&[0, 1]) || body.starts_with(&[0, 0])) || body.len() < 4 {
            let found = body[..body.len().min(4)].to_vec();
            return Err(BusError::Encapsulation { topic: state.writers[writer].topic.clone(), found });
        }
        Ok(state.publish(writer, body, about))
    }

    fn take(&mut self, subscription: SubscriptionId) -> Result<Option<Sample>, BusError> {
        let reader = *self.readers.get(subscription.0).ok_or(BusError::Handle("take"))?;
        let mut state = self.state.borrow_mut();
        let now = state.time.transit;
        while let Some(sample) = state.readers[reader].take(now) {
            let (taken, _) = self.admission.takes(sample.info.writer, &state.readers[reader].topic);
            if taken {
                state.readers[reader].taken += 1;
                return Ok(Some(sample));
            }
        }
        Ok(None)
    }

    fn wait(&mut self, timeout: Duration) -> Wake {
        if std::mem::take(&mut self.interrupted) {
            return Wake::Shutdown;
        }
        let mut state = self.state.borrow_mut();
        let deadline = state.time.now() + timeout;
        let due = self.readers.iter().filter_map(|r| state.readers[*r].next_due()).min();
        if let Some(due) = due.filter(|due| *due <= deadline) {
            state.time.advance_to(due);
            return Wake::Data;
        }
        if let Some(alarm) = state.time.alarm() {
            alarm.wait(timeout);
            return if alarm.was_called() { Wake::Called } else { Wake::Timeout };
        }
        state.time.advance_to(deadline);
        Wake::Timeout
    }

    fn caller(&self) -> Option<Caller> {
        let alarm = self.state.borrow().time.alarm().cloned();
        alarm.map(|alarm| Caller(Arc::new(move || alarm.call())))
    }

    fn stop_flag(&self) -> Option<Arc<AtomicBool>> {
        self.state.borrow().time.alarm().map(|alarm| Arc::clone(&alarm.stop))
    }

    fn longest_sample(&self) -> usize {
        // A single thread steps the nodes: none could take parts while another one waits for it.
        if self.state.borrow().time.alarm().is_some() { usize::MAX } else { BULK_LIMIT }
    }

    fn flush(&mut self, _timeout: Duration) -> bool {
        true
    }

    fn now(&self) -> Duration {
        self.state.borrow().time.now()
    }

    fn wall_nanos(&self) -> u64 {
        self.state.borrow().time.wall_nanos()
    }

    fn transport(&self) -> &'static str {
        "memory"
    }
}

impl Graph for MemoryBus {
    fn readers(&self, publisher: PublisherId) -> usize {
        let state = self.state.borrow();
        let Some(writer) = self.writers.get(publisher.0).map(|w| &state.writers[*w]) else { return 0 };
        let counts = |r: &&Reader| {
            let other = r.participant != self.participant && self.admission.admits(&r.participant);
            r.alive && r.topic == writer.topic && other
        };
        state.readers.iter().filter(counts).count()
    }

    fn is_read(&self, publisher: PublisherId) -> bool {
        let state = self.state.borrow();
        let writer = self.writers.get(publisher.0).map(|w| &state.writers[*w]);
        writer.is_some_and(|w| state.readers.iter().any(|r| r.alive && r.topic == w.topic))
    }

    fn writers(&self, subscription: SubscriptionId) -> usize {
        let state = self.state.borrow();
        let Some(reader) = self.readers.get(subscription.0).map(|r| &state.readers[*r]) else { return 0 };
        let writers = state.writers.iter().filter(|w| w.alive && w.topic == reader.topic);
        writers.filter(|w| self.counts(w.id)).count()
    }

    fn foreign_writers(&self, topic: &Topic) -> Vec<Guid> {
        let topic = self.names.resolve(topic.name).unwrap_or_default();
        let state = self.state.borrow();
        let on_topic = state.writers.iter().filter(|w| w.alive && w.topic == topic);
        let mut ids: Vec<Guid> = on_topic.map(|w| w.id).filter(|id| self.counts(*id)).collect();
        ids.sort();
        ids
    }

    fn offers(&self) -> Vec<Offer> {
        let state = self.state.borrow();
        let others = state.writers.iter().filter(|w| w.alive && self.counts(w.id));
        let offer = |w: &Writer| Offer {
            writer: w.id,
            topic: w.topic.clone(),
            type_name: w.type_name.to_owned(),
            qos: w.qos,
            type_hash: String::new(),
        };
        let mut offers: Vec<Offer> = others.map(offer).collect();
        offers.sort_by(|a, b| (&a.topic, a.writer).cmp(&(&b.topic, b.writer)));
        offers
    }

    fn identity(&self) -> Identity {
        *self.admission.identity()
    }

    fn strangers(&self) -> Vec<Stranger> {
        self.admission.strangers()
    }

    fn describe(&self, writer: Guid) -> Stranger {
        self.admission.describe(&writer.participant())
    }
}

impl Statistics for MemoryBus {
    fn count_published(&mut self, publisher: PublisherId, topic: &Topic) -> Result<(), BusError> {
        let resolved = self.names.resolve(topic.name)?;
        let writer = *self.writers.get(publisher.0).ok_or(BusError::Handle("count_published"))?;
        *self.wholes.entry((writer, resolved)).or_default() += 1;
        Ok(())
    }

    fn published(&self) -> Vec<Published> {
        let state = self.state.borrow();
        let of = |place: &usize| {
            let w = &state.writers[*place];
            let one = |topic: &str, count| Published { topic: topic.into(), writer: w.id, count, full: 0 };
            let wholes = self.wholes.iter().filter(|((writer, _), _)| writer == place);
            let wholes = wholes.map(|((_, topic), count)| one(topic, *count));
            wholes.chain([one(&w.topic, w.count)]).collect::<Vec<_>>()
        };
        self.writers.iter().flat_map(of).collect()
    }

    fn received(&self) -> Vec<Received> {
        let state = self.state.borrow();
        let of = |r: &usize| {
            let r = &state.readers[*r];
            Received { topic: r.topic.clone(), taken: r.taken, refused: r.refused }
        };
        self.readers.iter().map(of).collect()
    }

    fn count_refused(&mut self, subscription: SubscriptionId) {
        if let Some(reader) = self.readers.get(subscription.0) {
            self.state.borrow_mut().readers[*reader].refused += 1;
        }
    }

    fn announced(&self, _subscription: SubscriptionId) -> Vec<Announced> {
        Vec::new()
    }
}

impl Drop for MemoryBus {
    fn drop(&mut self) {
        let mut state = self.state.borrow_mut();
        for writer in &self.writers {
            state.writers[*writer].alive = false;
        }
        for reader in &self.readers {
            state.readers[*reader].alive = false;
        }
    }
}
