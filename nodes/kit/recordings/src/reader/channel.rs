//! Topics of a recording.

use grainlab_any_message::{Comparison, Schema};
use mcap::McapError;
use std::collections::BTreeMap;
use std::io::{Seek, Write};

use super::definition::StoredDefinition;

/// The description of one topic in a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelInfo {
    /// Absolute name, `/stress`.
    pub topic: String,
    /// Type, `grainlab_msgs/msg/Stress`; empty if the channel has no schema.
    pub ros_type: String,
    /// Schema text; `ros2msg` in recordings of ROS 2.
    pub definition: String,
    /// The schema as it is in the file, which need not be text in other encodings.
    pub schema: Vec<u8>,
    /// Encoding of the schema.
    pub schema_encoding: String,
    /// Encoding of the messages; `cdr` in recordings of ROS 2.
    pub message_encoding: String,
    /// Offered QoS as the YAML list of rosbag2; empty if unknown.
    pub qos: String,
    /// `RIHS01_…`, or empty if unknown.
    pub type_hash: String,
    /// All metadata of the channel, QoS and type hash included.
    pub metadata: BTreeMap<String, String>,
    /// Relation of its definition to the type of this name in this program.
    pub stored: StoredDefinition,
}

impl ChannelInfo {
    /// True if messages of both have the same bytes for the same content: definitions may differ in comments and defaults.
    pub fn is_read_as(&self, other: &Self) -> bool {
        let encodings = |c: &Self| (c.message_encoding.clone(), c.schema_encoding.clone());
        if self.ros_type != other.ros_type || encodings(self) != encodings(other) {
            return false;
        }
        if self.schema == other.schema {
            return true;
        }
        let parsed = |c: &Self| {
            Schema::parse(&c.ros_type, &c.definition).ok().filter(|_| c.schema_encoding == "ros2msg")
        };
        match (parsed(self), parsed(other)) {
            // A copy may have the hash of another definition. Defaults of fields are in no message.
            (Some(a), Some(b)) => [a.compare(&b), b.compare(&a)].iter().all(|c| *c == Comparison::Same),
            _ => !self.type_hash.is_empty() && self.type_hash == other.type_hash,
        }
    }

    /// The property in which both differ: its name, and the value of each.
    pub fn differs_as<'a>(&'a self, other: &'a Self) -> Option<(&'static str, &'a str, &'a str)> {
        let of = |c: &'a Self| [&c.message_encoding, &c.ros_type, &c.schema_encoding];
        let names = ["encoding", "type", "encoding of the definition"];
        let mut all = names.into_iter().zip(of(self).into_iter().zip(of(other)));
        let (name, (mine, others)) = all.find(|(_, (mine, others))| mine != others)?;
        let word = |text: &'a String| if text.is_empty() { "unknown" } else { text };
        Some((name, word(mine), word(others)))
    }

    /// Declares the channel in another file; returns its id there. A schema may be empty.
    pub(crate) fn declare<W: Write + Seek>(&self, mcap: &mut mcap::Writer<W>) -> Result<u16, McapError> {
        let has_schema =
            !(self.ros_type.is_empty() && self.schema_encoding.is_empty() && self.schema.is_empty());
        let schema = match has_schema {
            true => mcap.add_schema(&self.ros_type, &self.schema_encoding, &self.schema)?,
            false => 0,
        };
        mcap.add_channel(schema, &self.topic, &self.message_encoding, &self.metadata)
    }

    /// True for messages in CDR whose definition is not in the recording.
    pub fn is_without_definition(&self) -> bool {
        // A type without fields has an empty definition.
        self.schema.is_empty() && self.schema_encoding.is_empty() && self.message_encoding == "cdr"
    }

    /// Advice for a channel [without a definition](Self::is_without_definition).
    pub fn advice(&self) -> String {
        let kind = &self.ros_type;
        if kind.is_empty() {
            return "the recording has neither its type nor a definition".to_owned();
        }
        format!(
            "the recording has no definition of {kind}: give a folder that contains {kind}.msg with --msg-path"
        )
    }

    /// True if the recorded QoS is transient local: late readers get the last message.
    pub fn is_latched(&self) -> bool {
        // rosbag2 writes an integer up to version 8 of its metadata, a word from version 9 on.
        self.qos_values("durability").any(|v| matches!(v, "1" | "transient_local"))
    }

    /// Number of messages that a late reader of a latched topic gets, by the recorded QoS: its depth, at least 1 and at most 1000,
    /// which is also that of keep all.
    pub fn latched_depth(&self) -> usize {
        if self.qos_values("history").any(|v| matches!(v, "2" | "keep_all")) {
            return 1000;
        }
        let depths = self.qos_values("depth").filter_map(|v| v.parse::<usize>().ok());
        depths.max().unwrap_or(1).clamp(1, 1000)
    }

    fn qos_values<'a>(&'a self, key: &'a str) -> impl Iterator<Item = &'a str> {
        self.qos.lines().filter_map(move |line| {
            let (found, value) = line.trim_start_matches(['-', ' ']).split_once(':')?;
            (found.trim() == key).then_some(value.trim())
        })
    }
}
