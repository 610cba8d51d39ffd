//! Nodes and endpoints of a domain.

use crate::names::{RosName, ros_type};
use grainlab_msgs::Guid;
use grainlab_node_kit::{may_be_ours, type_hash};
use ros2_client::QosProfile;
use ros2_client::qos::{Durability, Reliability};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// A publisher or subscription.
#[derive(Clone, Debug)]
pub(crate) struct Endpoint {
    pub(crate) guid: Guid,
    pub(crate) name: RosName,
    /// As in `grainlab_msgs/msg/Stress`.
    pub(crate) type_name: String,
    pub(crate) writes: bool,
    pub(crate) qos: QosProfile,
    /// `RIHS01_…`, or empty if it is not announced.
    pub(crate) type_hash: String,
    /// Numbers of the data representations (DDS-XTypes), the preferred one first. 0 is XCDR1; so is an empty list.
    pub(crate) representations: Vec<i16>,
}

impl Endpoint {
    pub(crate) fn new(guid: Guid, topic: &str, type_name: &str, writes: bool, qos: QosProfile) -> Self {
        let (name, type_name, type_hash) = (RosName::of(topic), ros_type(type_name), String::new());
        Self { guid, name, type_name, writes, qos, type_hash, representations: vec![0] }
    }

    pub(crate) fn represented(self, announced: Option<Vec<i16>>) -> Self {
        let representations = announced.filter(|all| !all.is_empty()).unwrap_or_else(|| vec![0]);
        Self { representations, ..self }
    }

    /// This endpoint with the hash in its user data.
    pub(crate) fn announcing(self, user_data: &[u8]) -> Self {
        Self { type_hash: type_hash(user_data), ..self }
    }

    pub(crate) fn participant(&self) -> [u8; 12] {
        self.guid.participant()
    }

    /// True for an endpoint of CycloneDDS: the vendor id, with which every GUID begins.
    pub(crate) fn is_cyclone(&self) -> bool {
        self.guid.0[..2] == [0x01, 0x10]
    }
}

#[derive(Clone, Debug)]
pub(crate) struct NodeEntry {
    pub(crate) name: String,
    pub(crate) participant: Guid,
    pub(crate) endpoints: BTreeSet<Guid>,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Graph {
    pub(crate) nodes: Vec<NodeEntry>,
    pub(crate) endpoints: Vec<Endpoint>,
}

#[derive(Default)]
pub(crate) struct TopicEntry<'a> {
    pub(crate) publishers: Vec<&'a Endpoint>,
    pub(crate) subscriptions: Vec<&'a Endpoint>,
}

impl TopicEntry<'_> {
    /// Publishers, then subscriptions.
    pub(crate) fn endpoints(&self) -> impl Iterator<Item = &Endpoint> {
        self.publishers.iter().chain(&self.subscriptions).copied()
    }

    /// The types of its endpoints; more than one is a mistake.
    pub(crate) fn types(&self) -> BTreeSet<&str> {
        self.endpoints().map(|e| e.type_name.as_str()).collect()
    }
}

impl Graph {
    pub(crate) fn topics(&self) -> BTreeMap<&str, TopicEntry<'_>> {
        let mut topics: BTreeMap<&str, TopicEntry<'_>> = BTreeMap::new();
        for endpoint in &self.endpoints {
            if let RosName::Topic(name) = &endpoint.name {
                let entry = topics.entry(name).or_default();
                let list = if endpoint.writes { &mut entry.publishers } else { &mut entry.subscriptions };
                list.push(endpoint);
            }
        }
        topics
    }

    /// Services by name: the reader of requests of each server.
    pub(crate) fn services(&self) -> BTreeMap<&str, Vec<&Endpoint>> {
        let mut services: BTreeMap<&str, Vec<&Endpoint>> = BTreeMap::new();
        for endpoint in self.endpoints.iter().filter(|e| !e.writes) {
            if let RosName::Request(name) = &endpoint.name {
                services.entry(name).or_default().push(endpoint);
            }
        }
        services
    }

    /// The node of an endpoint, or else the participant in hexadecimal.
    pub(crate) fn owner(&self, endpoint: &Endpoint) -> String {
        let named = self.nodes.iter().find(|n| n.endpoints.contains(&endpoint.guid)).or_else(|| {
            // A program with one node may list fewer endpoints than it has.
            let mut same =
                self.nodes.iter().filter(|n| n.participant.participant() == endpoint.participant());
            same.next().filter(|_| same.next().is_none())
        });
        named.map_or_else(
            || format!("participant {}", &Guid::of_participant(endpoint.participant()).to_string()[..24]),
            |node| node.name.clone(),
        )
    }

    /// Names of the owners, each once.
    pub(crate) fn owners<'a>(&self, endpoints: impl IntoIterator<Item = &'a Endpoint>) -> String {
        let owners: BTreeSet<String> = endpoints.into_iter().map(|e| self.owner(e)).collect();
        owners.into_iter().collect::<Vec<_>>().join(", ")
    }

    /// The nodes of this program that publish reports: one a second. What others publish on this topic, and when, is their own.
    pub(crate) fn reporting(&self) -> BTreeSet<String> {
        let topics = self.topics();
        let publishers = topics.get("/diagnostics").map(|t| t.publishers.as_slice()).unwrap_or_default();
        let ours = |e: &&&Endpoint| may_be_ours(&e.participant());
        publishers.iter().filter(ours).map(|e| self.owner(e)).collect()
    }

    pub(crate) fn endpoints_of(&self, node: &NodeEntry) -> Vec<&Endpoint> {
        self.endpoints.iter().filter(|e| node.endpoints.contains(&e.guid)).collect()
    }
}

/// The policies of an endpoint in the words of `ros2 topic info`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct QosView {
    pub(crate) reliability: &'static str,
    pub(crate) durability: &'static str,
}

impl From<&QosProfile> for QosView {
    fn from(qos: &QosProfile) -> Self {
        Self {
            reliability: if is_reliable(qos) { "reliable" } else { "best_effort" },
            durability: if is_transient_local(qos) { "transient_local" } else { "volatile" },
        }
    }
}

pub(crate) fn is_reliable(qos: &QosProfile) -> bool {
    matches!(qos.reliability, Reliability::Reliable { .. })
}

pub(crate) fn is_transient_local(qos: &QosProfile) -> bool {
    !matches!(qos.durability, Durability::Volatile)
}
