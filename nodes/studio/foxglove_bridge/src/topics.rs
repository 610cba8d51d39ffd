//! The topics of the bus as channels of the server.

use crate::pictures::Pictures;
use crate::server::{Channel, Request, Server};
use grainlab_msgs::{Qos, Topic, topics};
use grainlab_node_kit::{Bus, BusError, Demand, Offer, Sample, Source};
use grainlab_recordings::{Definitions, adapted};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::time::Duration;

/// Samples queued between two steps of the node, and packings, which have megabytes each.
const BACKLOG: u32 = 1_000;
const PACKINGS: u32 = 8;

/// Most latched samples kept of a topic for a client that subscribes after another one.
const KEPT: usize = 128;

/// A topic of the bus.
struct Bridged {
    topic: Topic,
    channel: Channel,
    /// Pictures beside a topic with packings.
    pictures: Option<Pictures>,
    /// While a client subscribes.
    source: Option<Source>,
    /// The samples that a late reader gets, while a client subscribes.
    latched: VecDeque<Sample>,
}

/// All topics of known types.
pub(crate) struct Topics {
    definitions: Definitions,
    all: BTreeMap<String, Bridged>,
    /// Topics of which it was said that they have no channel.
    refused: BTreeSet<String>,
    /// Samples passed on.
    pub(crate) samples: u64,
}

fn time(sample: &Sample) -> u64 {
    sample.info.source_time.unwrap_or(sample.info.received)
}

impl Topics {
    pub(crate) fn new(definitions: Definitions) -> Self {
        Self { definitions, all: BTreeMap::new(), refused: BTreeSet::new(), samples: 0 }
    }

    /// Number of topics, and of those that are received.
    pub(crate) fn counts(&self) -> (usize, usize) {
        (self.all.len(), self.all.values().filter(|t| t.source.is_some()).count())
    }

    /// Makes channels for topics that appeared, and closes those of topics that nobody publishes any longer.
    pub(crate) fn follow(&mut self, bus: &mut dyn Bus, server: &Server) {
        let mut offered: BTreeMap<String, Vec<Offer>> = BTreeMap::new();
        for offer in bus.offers() {
            offered.entry(offer.topic.clone()).or_default().push(offer);
        }
        let is_published = |name: &str| offered.contains_key(name);
        self.all.retain(|name, bridged| {
            let is_kept = is_published(name);
            if !is_kept {
                bridged.unsubscribe(bus);
            }
            is_kept
        });
        for (name, offers) in &offered {
            if !self.all.contains_key(name)
                && let Some(found) = self.found(server, name, offers, &is_published)
            {
                self.all.insert(name.clone(), found);
            }
        }
    }

    fn found(
        &mut self,
        server: &Server,
        name: &str,
        offers: &[Offer],
        is_published: &dyn Fn(&str) -> bool,
    ) -> Option<Bridged> {
        let first = offers.first()?;
        if [&topics::PACKING_CHUNK, &topics::PACKING_CREDIT]
            .iter()
            .any(|t| t.info.type_name == first.type_name)
        {
            return None;
        }
        let refuse = |reason: String, refused: &mut BTreeSet<String>| {
            if refused.insert(name.to_owned()) {
                log::warn!("{name} is not offered to viewers: {reason}");
            }
        };
        if let Some(other) = offers.iter().find(|o| o.type_name != first.type_name) {
            let reason =
                format!("its writers have different types, {} and {}", first.type_name, other.type_name);
            refuse(reason, &mut self.refused);
            return None;
        }
        let hash = offers.iter().map(|o| o.type_hash.as_str()).find(|h| !h.is_empty()).unwrap_or_default();
        let definition = match self.definitions.text(&first.type_name, hash) {
            Ok(definition) => definition,
            Err(error) => {
                refuse(error.to_string().replace("--msg-path", "-p msg_path:=[FOLDER]"), &mut self.refused);
                return None;
            }
        };
        let qos = adapted(&offers.iter().map(|o| o.qos).collect::<Vec<Qos>>());
        // Discovery does not say how many samples a writer keeps.
        let row = Topic::by_name(name).filter(|row| row.info.type_name == first.type_name);
        let qos = Qos { depth: row.map_or(qos.depth, |row| row.qos.depth), ..qos };
        let topic = Topic::outside_contract(name, &first.type_name, qos)?;
        let channel = server.channel(name, &first.type_name, &definition);
        let is_packing = topic.info == topics::PACKING.info;
        let pictures = is_packing.then(|| Pictures::advertise(server, name, is_published));
        self.refused.remove(name);
        Some(Bridged { topic, channel, pictures, source: None, latched: VecDeque::new() })
    }

    /// Sends the latched samples of a topic that is already received to a client that subscribed.
    pub(crate) fn answer(&self, request: Request) {
        let wanted = |t: &&Bridged| {
            t.channel.id() == request.channel || t.pictures.as_ref().is_some_and(|p| p.has(request.channel))
        };
        let Some(bridged) = self.all.values().find(wanted) else { return };
        for sample in &bridged.latched {
            if bridged.channel.id() == request.channel {
                bridged.channel.send(&sample.body, time(sample), Some(request.client));
            } else if let Some(pictures) = &bridged.pictures {
                pictures.send(&sample.body, time(sample), Some(request));
            }
        }
    }

    /// Subscribes to what clients want, ends the other subscriptions, and passes on what arrived.
    pub(crate) fn pass_on(&mut self, bus: &mut dyn Bus) -> Result<(), BusError> {
        for bridged in self.all.values_mut() {
            match (bridged.wanted(), bridged.source.is_some()) {
                (true, false) => bridged.source = Some(bridged.open(bus)?),
                (false, true) => bridged.unsubscribe(bus),
                _ => {}
            }
            let Some(source) = &mut bridged.source else { continue };
            while let Some(sample) = source.take(bus)? {
                self.samples += 1;
                bridged.channel.send(&sample.body, time(&sample), None);
                if let Some(pictures) = &bridged.pictures {
                    pictures.send(&sample.body, time(&sample), None);
                }
                if bridged.topic.qos.transient_local {
                    bridged.latched.push_back(sample);
                    let most = (bridged.topic.qos.depth.max(1) as usize).min(KEPT);
                    bridged.latched.drain(..bridged.latched.len().saturating_sub(most));
                }
            }
        }
        Ok(())
    }

    /// Longest wait until the next call of [`Topics::pass_on`].
    pub(crate) fn patience(&self, now: Duration) -> Duration {
        let sources = self.all.values().filter_map(|t| t.source.as_ref());
        sources.map(|s| s.patience(now)).min().unwrap_or(Duration::MAX)
    }
}

impl Bridged {
    /// Subscribes. A topic that keeps samples for late readers is read reliably, because only such a reader gets them; any
    /// other one without repetition, so that its writer never waits for a viewer.
    fn open(&self, bus: &mut dyn Bus) -> Result<Source, BusError> {
        let latched = self.topic.qos.transient_local && self.topic.qos.reliable;
        let qos = Qos { reliable: latched, transient_local: latched, ..self.topic.qos };
        let depth = if self.pictures.is_some() { PACKINGS } else { BACKLOG };
        Source::open(bus, &Topic { qos, ..self.topic }, Demand { reliable: latched, depth })
    }

    fn wanted(&self) -> bool {
        self.channel.is_wanted() || self.pictures.as_ref().is_some_and(Pictures::wanted)
    }

    fn unsubscribe(&mut self, bus: &mut dyn Bus) {
        if let Some(source) = self.source.take() {
            source.close(bus);
        }
        self.latched.clear();
    }
}
