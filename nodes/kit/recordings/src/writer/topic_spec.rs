//! The declaration of a topic in a recording.

use crate::reader::ChannelInfo;
use grainlab_any_message::{Comparison, Schema};
use grainlab_msgs::{Qos, Topic, TypeInfo};

/// Encoding of schemas that are message files.
const ROS2MSG: &str = "ros2msg";

/// The declaration of a channel of the recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TopicSpec {
    /// Absolute name, `/stress`.
    pub name: String,
    /// ROS type, `grainlab_msgs/msg/Stress`.
    pub ros_type: String,
    /// Schema: the `.msg` text followed by those it depends on.
    pub definition: String,
    /// Encoding of the schema: `ros2msg`, or empty if it is unknown.
    pub schema_encoding: String,
    /// `RIHS01_<64 hexadecimal digits>`, or empty if unknown.
    pub type_hash: String,
    /// QoS offered, as the YAML list of rosbag2 with integers, or empty if unknown.
    pub qos: String,
}

impl TopicSpec {
    /// The channel of a topic of the topic table, under its full name (with the namespace, if any).
    pub fn of_contract(topic: &Topic, full_name: &str) -> Self {
        let mut spec = Self::of_type(&topic.info, full_name);
        spec.qos = topic.qos.offered_qos_profiles();
        spec
    }

    pub(crate) fn of_channel(channel: &ChannelInfo) -> Self {
        Self {
            name: channel.topic.clone(),
            ros_type: channel.ros_type.clone(),
            definition: channel.definition.clone(),
            schema_encoding: channel.schema_encoding.clone(),
            type_hash: channel.type_hash.clone(),
            qos: channel.qos.clone(),
        }
    }

    /// Returns true if messages of `earlier` are read as messages of this topic, by the names of their fields.
    pub(super) fn continues(&self, earlier: &Self) -> bool {
        let same = |of: fn(&Self) -> [&str; 4]| of(self) == of(earlier);
        let parsed = |spec: &Self| Schema::parse(&spec.ros_type, &spec.definition).ok();
        let is_read = || match (parsed(earlier), parsed(self)) {
            (Some(earlier), Some(own)) => !matches!(earlier.compare(&own), Comparison::Differs(_)),
            _ => false,
        };
        same(|spec| [&spec.name, &spec.ros_type, &spec.schema_encoding, &spec.qos]) && is_read()
    }

    /// A channel of any known type; its QoS is unknown.
    pub fn of_type(info: &TypeInfo, full_name: &str) -> Self {
        Self {
            name: full_name.to_owned(),
            ros_type: info.type_name.to_owned(),
            definition: info.definition.to_owned(),
            schema_encoding: ROS2MSG.to_owned(),
            type_hash: info.hash.to_owned(),
            qos: String::new(),
        }
    }

    /// A channel of a topic outside the contract, with what its writers offer. Without a definition the schema is empty: a
    /// reader then needs one from elsewhere.
    pub fn of_found(topic: &Topic, definition: Option<String>, type_hash: &str, offered: &[Qos]) -> Self {
        let encoding = if definition.is_some() { ROS2MSG } else { "" };
        let profiles: Vec<String> = offered.iter().map(Qos::offered_qos_profiles).collect();
        Self {
            name: topic.name.to_owned(),
            ros_type: topic.info.type_name.to_owned(),
            definition: definition.unwrap_or_default(),
            schema_encoding: encoding.to_owned(),
            type_hash: type_hash.to_owned(),
            qos: profiles.join("\n"),
        }
    }
}
