//! The node in the ROS graph: `ros2 node list` and `ros2 node info` read `ros_discovery_info`.

use super::error::create_error;
use crate::bus_error::BusError;
use crate::names::Names;
use ros2_client::Gid;
use ros2_client::NodeName;
use ros2_client::builtin_topics::ros_discovery::{QOS_PUB, TOPIC_NAME, TYPE_NAME};
use ros2_client::entities_info::{NodeEntitiesInfo, ParticipantEntitiesInfo};
use rustdds::no_key::DataWriterCdr;
use rustdds::{DomainParticipant, GUID, Publisher, RTPSEntity, TopicKind};

/// Announces the endpoints of this node to the ROS graph.
pub(super) struct RosGraph {
    writer: DataWriterCdr<ParticipantEntitiesInfo>,
    participant: GUID,
    node: NodeEntitiesInfo,
    dirty: bool,
}

impl RosGraph {
    pub(super) fn new(
        participant: &DomainParticipant,
        publisher: &Publisher,
        names: &Names,
    ) -> Result<Self, BusError> {
        let topic = participant
            .create_topic(TOPIC_NAME.into(), TYPE_NAME.into(), &QOS_PUB, TopicKind::NoKey)
            .map_err(|e| create_error("ros_discovery_info", &e))?;
        let writer = publisher
            .create_datawriter_no_key_cdr(&topic, Some(QOS_PUB.clone()))
            .map_err(|e| create_error("ros_discovery_info", &e))?;
        let name = NodeName::new(names.namespace(), names.node()).map_err(|e| BusError::Network {
            what: format!("node name {names}"),
            reason: format!("{e:?}"),
        })?;
        let mut node = NodeEntitiesInfo::new(name);
        node.add_writer(Gid::from(writer.guid()));
        Ok(Self { writer, participant: participant.guid(), node, dirty: true })
    }

    pub(super) fn add_writer(&mut self, guid: GUID) {
        self.node.add_writer(Gid::from(guid));
        self.dirty = true;
    }

    pub(super) fn add_reader(&mut self, guid: GUID) {
        self.node.add_reader(Gid::from(guid));
        self.dirty = true;
    }

    /// Announces the changes since the last call, in at most one message.
    pub(super) fn announce(&mut self) {
        if !std::mem::take(&mut self.dirty) {
            return;
        }
        let info = ParticipantEntitiesInfo::new(Gid::from(self.participant), vec![self.node.clone()]);
        if let Err(error) = self.writer.write(info, None) {
            log::warn!("cannot announce the node to the ROS graph: {error:?}");
        }
    }
}
