//! The description of a topic.

use crate::message::TypeInfo;

/// One row of the contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Topic {
    /// Name: those of this project are relative, so that a namespace applies to them; the standard ones are
    /// absolute.
    pub name: &'static str,
    /// Type, schema text and hash.
    pub info: TypeInfo,
    /// The QoS that the writer offers.
    pub qos: Qos,
    /// Node that publishes it; `an instrument` where no node of ours does.
    pub writer: &'static str,
    /// True if every recorded byte is a function of scene and seed: without a wall clock or a counter of a
    /// process. If it is transient local, too, the recorder writes each message to disk at once.
    pub reproducible: bool,
}

/// Quality of service that a writer offers. History is always keep last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Qos {
    /// Reliable, else best effort.
    pub reliable: bool,
    /// Samples kept for a reader.
    pub depth: u32,
    /// Transient local (a late reader gets the last samples), else volatile.
    pub transient_local: bool,
}

/// In the words of ROS 2.
impl std::fmt::Display for Qos {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let reliability = if self.reliable { "reliable" } else { "best effort" };
        let durability = if self.transient_local { "transient local" } else { "volatile" };
        write!(f, "{reliability}, {durability}, depth {}", self.depth)
    }
}

impl Qos {
    /// Streams without losses.
    pub const STREAM: Self = Self { reliable: true, depth: 1000, transient_local: false };
    /// States of which only the latest matters.
    pub const LATCHED: Self = Self { reliable: true, depth: 1, transient_local: true };
    /// States of several messages: a late reader gets as many as form a complete one.
    pub const LATCHED_SET: Self = Self { reliable: true, depth: 128, transient_local: true };
    /// For `/clock`: reliable, so that a recorder gets every tick; ROS 2's best-effort readers match it, too.
    pub const CLOCK: Self = Self { reliable: true, depth: 10, transient_local: false };
    /// For parts of messages too large for one sample: the bus repeats nothing, because readers request
    /// missing parts, so that a crashed reader does not block the writer. The depth is the number of parts
    /// that may be in transit at once.
    pub const PARTS: Self = Self { reliable: false, depth: 32, transient_local: false };
    /// Samples of a fast topic, for viewers: nothing is kept or repeated for them.
    pub const SAMPLED: Self = Self { reliable: false, depth: 32, transient_local: false };
    /// ROS 2's for `/rosout`.
    pub const ROSOUT: Self = Self { reliable: true, depth: 1000, transient_local: true };

    /// The profile as rosbag2 writes it into a channel's `offered_qos_profiles` and, as a string, into
    /// metadata.yaml: a list with one map, with numbers instead of words, which every distribution reads. No
    /// newline at the end.
    ///
    /// A depth of 0 is an unknown history, as of a writer that discovery found.
    pub fn offered_qos_profiles(&self) -> String {
        let history = if self.depth == 0 { 3 } else { 1 };
        let reliability = if self.reliable { 1 } else { 2 };
        let durability = if self.transient_local { 1 } else { 2 };
        // Seconds and nanoseconds of the infinite duration of ROS 2: 2^63 - 1 ns.
        let infinite = "\n    sec: 9223372036\n    nsec: 854775807";
        format!(
            "- history: {history}\n  depth: {depth}\n  reliability: {reliability}\n  durability: {durability}\n  \
             deadline:{infinite}\n  lifespan:{infinite}\n  liveliness: 1\n  liveliness_lease_duration:{infinite}\n  \
             avoid_ros_namespace_conventions: false",
            depth = self.depth
        )
    }
}

impl Topic {
    /// A topic outside the contract with the full name `name`, of any type `package/kind/Name`; `None` if the type is not
    /// written so. Its texts are kept to the end of the process, as those of the contract are.
    pub fn outside_contract(name: &str, type_name: &str, qos: Qos) -> Option<Self> {
        let constant = |text: &str| -> &'static str { String::from(text).leak() };
        let [package, _, short] = type_name.split('/').collect::<Vec<_>>()[..] else { return None };
        let info = TypeInfo::by_name(type_name).copied().unwrap_or_else(|| TypeInfo {
            package: constant(package),
            name: constant(short),
            type_name: constant(type_name),
            hash: "",
            fields: &[],
            definition: "",
        });
        Some(Self { name: constant(name), info, qos, writer: "", reproducible: false })
    }

    /// Name in a recording without namespace: `/stress`.
    pub fn absolute_name(&self) -> String {
        format!("/{}", self.name.trim_start_matches('/'))
    }
}
