//! Joins a domain and collects its graph.

use crate::graph::{Endpoint, Graph, NodeEntry};
use grainlab_console::{Failure, escape_name};
use grainlab_msgs::Guid;
use grainlab_node_kit::{CROWDING_ADVICE, Network, OffTheBus, crowding};
use ros2_client::qos::{Durability, History, Reliability, WhenFull};
use ros2_client::{Context, MessageTypeName, Node, NodeName, NodeOptions, QosProfile, Subscription};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

const POLL_PERIOD: Duration = Duration::from_millis(20);

/// Time without a change after which the graph counts as complete, and after which that of one name does once it is there.
const QUIET: Duration = Duration::from_secs(2);
const QUIET_AROUND: Duration = Duration::from_millis(500);

/// `rmw_dds_common/msg/ParticipantEntitiesInfo`: the nodes of one participant. ros2-client's own type hides the endpoints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ParticipantNodes {
    gid: Guid,
    nodes: Vec<Entities>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Entities {
    namespace: String,
    name: String,
    readers: Vec<Guid>,
    writers: Vec<Guid>,
}

/// A participant that belongs to no run.
pub(crate) struct Observer {
    pub(crate) node: Node,
    pub(crate) context: Context,
    announcements: Subscription<ParticipantNodes>,
    announced: BTreeMap<Guid, ParticipantNodes>,
    own: [u8; 12],
}

impl Observer {
    /// Joins the domain and network of the environment.
    pub(crate) fn join() -> Result<Self, Failure> {
        OffTheBus::note().iter().for_each(|note| grainlab_console::say!("grainlab: {note}"));
        Self::join_network(Network::from_env().map_err(Failure::usage)?)
    }

    pub(crate) fn join_network(network: Network) -> Result<Self, Failure> {
        let context = network.context().map_err(Failure::failed)?;
        // Several tools may run at once.
        let name = format!("_grainlab_tool_{}", std::process::id());
        let name = NodeName::new("/", &name).map_err(Failure::failed)?;
        let options = NodeOptions::new().enable_rosout(false).start_parameter_services(false);
        let mut node = context.new_node(name, options).map_err(Failure::failed)?;
        let qos = QosProfile::publisher_default()
            .reliability_reliable(WhenFull::DEFAULT)
            .durability(Durability::TransientLocal)
            .history(History::KeepLast { depth: 1000 });
        let info = MessageTypeName::new("rmw_dds_common", "ParticipantEntitiesInfo");
        let topic = context.create_topic("ros_discovery_info".into(), info, &qos).map_err(Failure::failed)?;
        let announcements = node.create_subscription(&topic, Some(qos)).map_err(Failure::failed)?;
        let own = Guid(announcements.gid().to_bytes16()).participant();
        Ok(Self { node, context, announcements, announced: BTreeMap::new(), own })
    }

    /// The graph once it has not changed for two seconds, or after `patience` at the latest.
    pub(crate) fn settled(&mut self, patience: Duration) -> Graph {
        self.with(patience, |_| false)
    }

    /// The graph once it has what is asked for and has not changed for half a second; without it, as [`Observer::settled`].
    /// Prints a line if participants are missing from it because the domain is full.
    pub(crate) fn with(&mut self, patience: Duration, is_there: impl Fn(&Graph) -> bool) -> Graph {
        let graph = self.discovered(patience, is_there);
        let crowding = self.crowding();
        crowding
            .iter()
            .for_each(|sentence| grainlab_console::say!("grainlab: {sentence}: {CROWDING_ADVICE}"));
        graph
    }

    /// A sentence about participants that are missing because the domain is full.
    pub(crate) fn crowding(&self) -> Option<String> {
        crowding(&self.context)
    }

    /// The graph as [`Observer::with`] returns it, without a line.
    pub(crate) fn discovered(&mut self, patience: Duration, is_there: impl Fn(&Graph) -> bool) -> Graph {
        let start = Instant::now();
        let (mut seen, mut changed, mut is_found) = (self.fingerprint(), start, false);
        loop {
            let quiet = changed.elapsed();
            if quiet >= QUIET || is_found && quiet >= QUIET_AROUND {
                return self.graph();
            }
            if start.elapsed() >= patience {
                let seconds = patience.as_secs_f64();
                grainlab_console::say!(
                    "grainlab: discovery ended after {seconds} s (--spin-time), before 2 s without a change: some of the graph may be missing"
                );
                return self.graph();
            }
            std::thread::sleep(POLL_PERIOD);
            let now = self.fingerprint();
            if now != seen {
                (seen, changed) = (now, Instant::now());
                is_found = is_there(&self.graph());
            }
        }
    }

    fn fingerprint(&mut self) -> (usize, usize, usize) {
        while let Ok(Some((participant, _))) = self.announcements.take() {
            self.announced.insert(participant.gid, participant);
        }
        let participant = self.context.domain_participant();
        let nodes = self.announced.values().flat_map(|p| &p.nodes);
        let announced = nodes.map(|n| n.readers.len() + n.writers.len()).sum();
        (participant.discovered_writers().len(), participant.discovered_readers().len(), announced)
    }

    /// The graph as it is known now, without this process.
    pub(crate) fn graph(&mut self) -> Graph {
        self.fingerprint();
        let participant = self.context.domain_participant();
        let writers = participant.discovered_writers().into_iter().map(|writer| {
            let data = &writer.publication_topic_data;
            let guid = writer.writer_proxy.remote_writer_guid.to_bytes();
            let qos = data.qos();
            let mut profile = QosProfile::from(&qos);
            // A policy that is not sent has its default, which for the reliability of a writer is not that of a reader (RTPS 2.3, table 9.14).
            if qos.reliability().is_none() {
                profile.reliability = Reliability::Reliable { when_full: WhenFull::DEFAULT };
            }
            Endpoint::new(Guid(guid), &data.topic_name, &data.type_name, true, profile)
                .announcing(&writer.user_data)
                .represented(qos.data_representation().map(|all| all.value))
        });
        let readers = participant.discovered_readers().into_iter().map(|reader| {
            let data = &reader.subscription_topic_data;
            let guid = reader.reader_proxy.remote_reader_guid.to_bytes();
            let qos = data.qos();
            Endpoint::new(Guid(guid), data.topic_name(), data.type_name(), false, QosProfile::from(&qos))
                .announcing(&reader.user_data)
                .represented(qos.data_representation().map(|all| all.value))
        });
        let endpoints: Vec<Endpoint> =
            writers.chain(readers).filter(|e| e.participant() != self.own).collect();
        // An announcement outlasts its participant.
        let there = |p: &&ParticipantNodes| endpoints.iter().any(|e| e.participant() == p.gid.participant());
        let mut nodes: Vec<NodeEntry> = self.announced.values().filter(there).flat_map(entries).collect();
        nodes.sort_by(|a, b| a.name.cmp(&b.name));
        Graph { nodes, endpoints }
    }
}

fn entries(participant: &ParticipantNodes) -> Vec<NodeEntry> {
    let entry = |node: &Entities| NodeEntry {
        name: escape_name(&format!("{}/{}", node.namespace.trim_end_matches('/'), node.name)).into_owned(),
        participant: participant.gid,
        endpoints: node.readers.iter().chain(&node.writers).copied().collect(),
    };
    participant.nodes.iter().map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_of_a_node_is_shown_without_what_a_terminal_obeys() {
        let node = Entities {
            namespace: "/lab".into(),
            name: "a\x1b[31m\nb".into(),
            readers: Vec::new(),
            writers: Vec::new(),
        };
        let found = entries(&ParticipantNodes { gid: Guid([1; 16]), nodes: vec![node] });
        assert_eq!(found[0].name, r"/lab/a\u{1b}[31m\nb");
    }
}
