//! Topics outside the contract, found on the bus.

use grainlab_msgs::{Qos, Topic, topics};
use grainlab_node_kit::{Bus, Offer};
use grainlab_recordings::{Definitions, QosOverrides, TopicNames, TopicSpec, TopicTally, adapted};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// Least number of samples queued while the disk is slow. RustDDS keeps as many, also after they were taken, and those of
/// other programs may be images.
const BACKLOG: u32 = 200;

/// Most of them, whatever the writers keep.
const MOST: u32 = 10_000;

/// Period at which new topics are looked for; a topic is subscribed to after one more, when all writers of a process that
/// has just been discovered are known.
const LOOK: Duration = Duration::from_millis(100);

/// Time after which named topics that nobody publishes are reported: a name may be misspelt.
const PATIENCE: Duration = Duration::from_secs(3);

/// Recorded topics outside the contract.
#[derive(Clone, Debug, Default)]
pub struct OtherTopics {
    /// Selection of topics.
    pub names: TopicNames,
    /// Record hidden topics, too.
    pub hidden: bool,
    /// Source of the definitions of their types.
    pub definitions: Definitions,
    /// The QoS of readers, instead of the one adapted to the writers; of topics of the contract, too.
    pub qos: QosOverrides,
}

impl OtherTopics {
    /// True if the topic of this full name is recorded.
    pub fn take(&self, name: &str) -> bool {
        self.names.take(name, None, self.hidden)
    }

    /// A topic of the contract with the QoS to ask for.
    pub(crate) fn requested(&self, topic: &Topic) -> Topic {
        Topic { qos: self.qos.apply(&topic.absolute_name(), topic.qos), ..*topic }
    }
}

pub(crate) struct FoundTopic {
    /// With the QoS to ask for.
    pub(crate) topic: Topic,
    pub(crate) spec: TopicSpec,
}

#[derive(Default)]
pub(crate) struct Finder {
    settings: OtherTopics,
    next_look: Duration,
    has_waited: bool,
    /// Time at which each topic that is not recorded yet was seen first.
    seen: BTreeMap<String, Duration>,
    /// Topics whose types nothing more is said about: found, or said to have more than one type, or another one than that of
    /// the contract.
    settled: BTreeSet<String>,
    /// Topics that are not recorded, as their publishers have different types.
    mixed: BTreeSet<String>,
    /// Topics that are recorded because a publisher was found.
    found: BTreeSet<String>,
}

impl Finder {
    pub(crate) fn new(settings: OtherTopics) -> Self {
        Self { settings, ..Self::default() }
    }

    /// The topics that appeared, without those in `known`.
    pub(crate) fn look(&mut self, bus: &dyn Bus, known: &BTreeSet<String>) -> Vec<FoundTopic> {
        let now = bus.now();
        if now < self.next_look {
            return Vec::new();
        }
        self.next_look = now + LOOK;
        if now >= PATIENCE && !std::mem::replace(&mut self.has_waited, true) {
            for name in self.missing(known) {
                log::warn!("/{name}: no process publishes it yet; it is recorded as soon as one does");
            }
        }
        let mut by_topic: BTreeMap<String, Vec<Offer>> = BTreeMap::new();
        for offer in bus.offers() {
            by_topic.entry(offer.topic.clone()).or_default().push(offer);
        }
        let mut found = Vec::new();
        for (name, offers) in by_topic {
            if known.contains(&name) {
                self.compare_with_contract(&name, &offers);
                continue;
            }
            if !self.settings.take(&name) || !is_recorded(&offers[0]) || !self.has_one_type(&name, &offers) {
                continue;
            }
            if now.saturating_sub(*self.seen.entry(name.clone()).or_insert(now)) >= LOOK {
                self.seen.remove(&name);
                self.settled.insert(name.clone());
                self.mixed.remove(&name);
                let of_topic = self.found(&name, &offers);
                self.found.extend(of_topic.iter().map(|_| name.clone()));
                found.extend(of_topic);
            }
        }
        found
    }

    /// Says of which named topics nothing was published, and of which found ones nothing was received. True if topics are missing for
    /// the types of their publishers.
    pub(crate) fn report_missing(&self, known: &BTreeSet<String>, tallies: &[TopicTally]) -> bool {
        let mixed: Vec<&String> = self.mixed.iter().filter(|name| !known.contains(*name)).collect();
        for name in &mixed {
            log::error!("{name} is not recorded: its publishers have different types");
        }
        for name in self.silent(tallies) {
            log::warn!(
                "{name}: nothing was received from its publishers: they sent nothing, or their QoS, partition or data \
                 representation suits no reader of ROS 2"
            );
        }
        for name in self.missing(known) {
            log::warn!("/{name} is not recorded: no process published it");
        }
        !mixed.is_empty()
    }

    /// The topics that were found, and are not in the recording.
    fn silent(&self, tallies: &[TopicTally]) -> Vec<&String> {
        let is_recorded = |name: &String| tallies.iter().any(|t| t.published > 0 && t.name == *name);
        self.found.iter().filter(|name| !is_recorded(name)).collect()
    }

    /// The named topics that were not found. Those of the contract may have another name, with namespace and remaps.
    fn missing(&self, known: &BTreeSet<String>) -> Vec<&str> {
        let absent = |name: &&str| {
            let whole = format!("/{name}");
            !known.contains(&whole) && !self.mixed.contains(&whole) && Topic::by_name(name).is_none()
        };
        self.settings.names.topics.iter().map(|name| name.trim_start_matches('/')).filter(absent).collect()
    }

    fn found(&self, name: &str, offers: &[Offer]) -> Option<FoundTopic> {
        let offered: Vec<Qos> = offers.iter().map(|o| o.qos).collect();
        let least = adapted(&offered);
        let qos = self.settings.qos.apply(name, Qos { depth: least.depth.clamp(BACKLOG, MOST), ..least });
        let type_name = &offers[0].type_name;
        let hash = offers.iter().map(|o| o.type_hash.as_str()).find(|h| !h.is_empty()).unwrap_or_default();
        let topic = Topic::outside_contract(name, type_name, qos)?;
        let definition = self.settings.definitions.text(type_name, hash);
        let definition = definition.map_err(|error| {
            log::warn!(
                "{name} is recorded without a schema, so that readers need one from elsewhere: {error}"
            );
        });
        if offered.iter().any(|o| o.reliable) && !least.reliable {
            log::warn!("{name}: not all of its writers are reliable, so that it is read best effort");
        }
        log::info!("{name}: found, {type_name}");
        let hash = if hash.is_empty() && definition.is_ok() { topic.info.hash } else { hash };
        let spec = TopicSpec::of_found(&topic, definition.ok(), hash, &offered);
        Some(FoundTopic { topic, spec })
    }

    /// True if all writers of a topic have one type; if not, says so once.
    fn has_one_type(&mut self, name: &str, offers: &[Offer]) -> bool {
        let types: BTreeSet<&str> = offers.iter().map(|o| o.type_name.as_str()).collect();
        if types.len() == 1 {
            return true;
        }
        if self.settled.insert(name.to_owned()) {
            let list = types.into_iter().collect::<Vec<_>>().join(" and ");
            log::error!("{name} is not recorded while its writers have different types: {list}");
        }
        self.mixed.insert(name.to_owned());
        false
    }

    /// Says once if a process publishes another type under the name of a recorded topic.
    fn compare_with_contract(&mut self, name: &str, offers: &[Offer]) {
        let Some(row) = Topic::by_name(name) else { return };
        let Some(other) = offers.iter().find(|o| o.type_name != row.info.type_name) else { return };
        if self.settled.insert(name.to_owned()) {
            log::error!(
                "{name}: messages of type {} by {} are not recorded: in this laboratory it is {}. Remap one of them (-r)",
                other.type_name,
                other.writer,
                row.info.type_name
            );
        }
    }
}

/// True for a topic with messages of its own: not parts or copies of another topic's messages, which are recorded there.
fn is_recorded(offer: &Offer) -> bool {
    let is_part = |t: &Topic| t.info.type_name == offer.type_name;
    let copies = Topic::by_name(&offer.topic).is_some_and(|t| !t.is_recorded() && is_part(t));
    ![topics::PACKING_CHUNK, topics::PACKING_CREDIT].iter().any(is_part) && !copies
}

#[cfg(test)]
mod tests;
