//! Topics of a recording.

/// The description of one topic in a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelInfo {
    /// Absolute name, `/stress`.
    pub topic: String,
    /// Type, `grainlab_msgs/msg/Stress`; empty if the channel has no schema.
    pub ros_type: String,
    /// Schema text; `ros2msg` in recordings of ROS 2.
    pub definition: String,
    /// Encoding of the schema.
    pub schema_encoding: String,
    /// Encoding of the messages; `cdr` in recordings of ROS 2.
    pub message_encoding: String,
    /// Offered QoS as the YAML list of rosbag2; empty if unknown.
    pub qos: String,
    /// `RIHS01_…`, or empty if unknown.
    pub type_hash: String,
}

impl ChannelInfo {
    /// Whether the recorded QoS is transient local: late readers get the last message.
    pub fn is_latched(&self) -> bool {
        // rosbag2 writes an integer up to version 8 of its metadata, a word from version 9 on.
        self.qos.lines().any(|line| {
            let mut parts = line.trim_start_matches(['-', ' ']).splitn(2, ':').map(str::trim);
            parts.next() == Some("durability") && matches!(parts.next(), Some("1" | "transient_local"))
        })
    }
}
