//! The contract: every topic with its type, QoS and writer. Topics are named only here.

use crate::message::TypeInfo;
use crate::topic::{Qos, Topic};
use crate::{diagnostic_msgs, msg, rcl_interfaces, rosgraph_msgs, sensor_msgs, tf2_msgs, visualization_msgs};

impl Topic {
    /// The row of a topic, by its name with or without the leading slash. Names of this project may have a
    /// namespace; the standard topics have none.
    ///
    /// ```
    /// use grainlab_msgs::Topic;
    /// assert_eq!(Topic::by_name("/lab_3/stress").unwrap().info.type_name, "grainlab_msgs/msg/Stress");
    /// assert!(Topic::by_name("/lab_3/clock").is_none());
    /// ```
    pub fn by_name(name: &str) -> Option<&'static Self> {
        TOPICS.iter().chain(PICTURES).find(|t| match t.name.strip_prefix('/') {
            Some(absolute) => name.strip_prefix('/').unwrap_or(name) == absolute,
            None => {
                name.strip_suffix(t.name).is_some_and(|before| before.is_empty() || before.ends_with('/'))
            }
        })
    }

    /// The row of a topic in a recording, by its name, or by its type where a remap gave it another name.
    ///
    /// ```
    /// use grainlab_msgs::{Topic, topics};
    /// assert_eq!(Topic::of_channel("/left/grains", "grainlab_msgs/msg/Packing"), Some(&topics::PACKING));
    /// assert_eq!(Topic::of_channel("/stress", "std_msgs/msg/String"), None);
    /// ```
    pub fn of_channel(name: &str, type_name: &str) -> Option<&'static Self> {
        let named = Self::by_name(name).filter(|t| type_name.is_empty() || t.info.type_name == type_name);
        named.or_else(|| TOPICS.iter().find(|t| t.is_recorded() && t.info.type_name == type_name))
    }

    /// True if recorders write it: parts of messages and copies of messages are left out.
    pub fn is_recorded(&self) -> bool {
        !self.is_transport() && self.name != STRESS_SAMPLED.name
    }

    /// True if it carries only parts of another topic's messages: it is never recorded, but the whole
    /// messages are.
    pub fn is_transport(&self) -> bool {
        self.info == PACKING_CHUNK.info || self.info == PACKING_CREDIT.info
    }
}

/// Requests to the servo.
pub const STRESS: Topic = Topic {
    name: "stress",
    info: TypeInfo::of::<msg::Stress>(),
    qos: Qos::STREAM,
    writer: "dem_simulator",
    reproducible: true,
    summary: "one request of the lockstep: stress, setpoints, clamps, tangent stiffness",
};

/// Some of the requests on [`STRESS`], for viewers: reading all of them costs a run time.
pub const STRESS_SAMPLED: Topic = Topic {
    name: "stress_sampled",
    info: TypeInfo::of::<msg::Stress>(),
    qos: Qos::SAMPLED,
    writer: "dem_simulator",
    reproducible: false,
    summary: "some of the requests, for viewers; never recorded, all requests are",
};

/// Answers of the servo.
pub const STRAIN_RATE: Topic = Topic {
    name: "strain_rate",
    info: TypeInfo::of::<msg::StrainRate>(),
    qos: Qos::STREAM,
    writer: "servo_controller",
    reproducible: true,
    summary: "the answer to one request: six strain rates",
};

/// The complete mechanical state.
pub const PACKING: Topic = Topic {
    name: "packing",
    info: TypeInfo::of::<msg::Packing>(),
    qos: Qos::LATCHED,
    writer: "dem_simulator",
    reproducible: true,
    summary: "the complete mechanical state: grains, contacts, loading path",
};

/// Parts of packings that are too large for one sample of [`PACKING`]. Recorders write the whole packing.
pub const PACKING_CHUNK: Topic = Topic {
    name: "packing_chunk",
    info: TypeInfo::of::<msg::PackingChunk>(),
    qos: Qos::PARTS,
    writer: "dem_simulator",
    reproducible: false,
    summary: "parts of a packing over 2 MB; never recorded, the whole packing is",
};

/// The parts that each reader of packings has.
pub const PACKING_CREDIT: Topic = Topic {
    name: "packing_credit",
    info: TypeInfo::of::<msg::PackingCredit>(),
    qos: Qos::PARTS,
    writer: "every reader of packings",
    reproducible: false,
    summary: "the parts that a reader has, and whether it takes more; never recorded",
};

/// Everything that is measured on a packing.
pub const PACKING_REPORT: Topic = Topic {
    name: "packing_report",
    info: TypeInfo::of::<msg::PackingReport>(),
    qos: Qos::LATCHED,
    writer: "fabric_analyzer",
    reproducible: true,
    summary: "structure, stress and stiffness of a packing",
};

/// Moduli of a sample.
pub const MODULI: Topic = Topic {
    name: "moduli",
    info: TypeInfo::of::<msg::Moduli>(),
    qos: Qos::LATCHED,
    writer: "an instrument",
    reproducible: true,
    summary: "moduli of a sample and the other inputs of an inversion; written only by instruments and other programs",
};

/// Wave speeds, real or virtual.
pub const WAVE_SPEEDS: Topic = Topic {
    name: "wave_speeds",
    info: TypeInfo::of::<msg::WaveSpeeds>(),
    qos: Qos::LATCHED,
    writer: "acoustic_probe",
    reproducible: true,
    summary: "wave speeds by direction and polarisation; an instrument may write them, too",
};

/// Traces of the wave speeds, one message per wave.
pub const WAVEFORM: Topic = Topic {
    name: "waveform",
    info: TypeInfo::of::<msg::Waveform>(),
    qos: Qos::LATCHED_SET,
    writer: "acoustic_probe",
    reproducible: true,
    summary: "the traces of the wave speeds, one message per wave",
};

/// Inferred microstructure of a packing.
pub const MICROSTRUCTURE: Topic = Topic {
    name: "microstructure",
    info: TypeInfo::of::<msg::Microstructure>(),
    qos: Qos::LATCHED,
    writer: "emt_inversion",
    reproducible: true,
    summary: "inferred microstructure, one estimate per model",
};

/// Phase and progress of the run.
pub const RUN_STATE: Topic = Topic {
    name: "run_state",
    info: TypeInfo::of::<msg::RunState>(),
    qos: Qos::LATCHED,
    writer: "dem_simulator",
    reproducible: false,
    summary: "phase, progress, finished, step of the last packing",
};

/// Energy balance of a phase, one message per phase, if the scene asks for it.
pub const ENERGY: Topic = Topic {
    name: "energy",
    info: TypeInfo::of::<msg::EnergyBalance>(),
    qos: Qos::LATCHED_SET,
    writer: "dem_simulator",
    reproducible: false,
    summary: "the energy balance of each phase, if the scene has energy_balance = true",
};

/// Simulated time, for tools; no node of grainlab waits for it.
pub const CLOCK: Topic = Topic {
    name: "/clock",
    info: TypeInfo::of::<rosgraph_msgs::Clock>(),
    qos: Qos::CLOCK,
    writer: "dem_simulator",
    reproducible: false,
    summary: "simulated time, at most 100 Hz of wall time",
};

/// Logs of all nodes.
pub const ROSOUT: Topic = Topic {
    name: "/rosout",
    info: TypeInfo::of::<rcl_interfaces::Log>(),
    qos: Qos::ROSOUT,
    writer: "every node",
    reproducible: false,
    summary: "logs",
};

/// Health. Deeper than ROS 2's 10, so that a recording is complete.
pub const DIAGNOSTICS: Topic = Topic {
    name: "/diagnostics",
    info: TypeInfo::of::<diagnostic_msgs::DiagnosticArray>(),
    qos: Qos::STREAM,
    writer: "every node",
    reproducible: false,
    summary: "health and counters of every node",
};

/// Frames for viewers.
pub const TF_STATIC: Topic = Topic {
    name: "/tf_static",
    info: TypeInfo::of::<tf2_msgs::TFMessage>(),
    qos: Qos::LATCHED,
    writer: "dem_simulator",
    reproducible: false,
    summary: "the frame of the cell, for viewers",
};

/// Grains for viewers.
pub const PACKING_POINTS: Topic = Topic {
    name: "packing/points",
    info: TypeInfo::of::<sensor_msgs::PointCloud2>(),
    qos: Qos::LATCHED,
    writer: "packing_pictures",
    reproducible: true,
    summary: "the grains of the packing as points, for viewers",
};

/// Grains, contacts and cell for viewers.
pub const PACKING_MARKERS: Topic = Topic {
    name: "packing/markers",
    info: TypeInfo::of::<visualization_msgs::MarkerArray>(),
    qos: Qos::LATCHED,
    writer: "packing_pictures",
    reproducible: true,
    summary: "grains, contacts and cell of the packing as markers, for viewers",
};

/// Pictures of the packing. They follow from [`PACKING`] at any time, so that a run does not record them.
pub const PICTURES: &[Topic] = &[PACKING_POINTS, PACKING_MARKERS];

/// Every topic of a run.
pub const TOPICS: &[Topic] = &[
    STRESS,
    STRESS_SAMPLED,
    STRAIN_RATE,
    PACKING,
    PACKING_CHUNK,
    PACKING_CREDIT,
    PACKING_REPORT,
    MODULI,
    WAVE_SPEEDS,
    WAVEFORM,
    MICROSTRUCTURE,
    RUN_STATE,
    ENERGY,
    CLOCK,
    ROSOUT,
    DIAGNOSTICS,
    TF_STATIC,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_only_ours_are_relative() {
        for (i, t) in TOPICS.iter().enumerate() {
            assert!(TOPICS[..i].iter().all(|other| other.name != t.name), "{}", t.name);
            assert_eq!(t.name.starts_with('/'), t.info.package != "grainlab_msgs", "{}", t.name);
            assert_eq!(Topic::by_name(t.name), Some(t));
            assert_eq!(Topic::by_name(&t.absolute_name()), Some(t));
            assert_eq!(TypeInfo::by_name(t.info.type_name), Some(&t.info));
        }
        assert_eq!(Topic::by_name("/lab/packing/points"), Some(&PACKING_POINTS));
        assert_eq!(Topic::by_name("points"), None);
        assert_eq!(Topic::by_name("stresses"), None);
        assert_eq!(Topic::by_name(""), None);
    }

    #[test]
    fn profiles_are_written_as_rosbag2_writes_them() {
        let expected = "- history: 1\n  depth: 10\n  reliability: 1\n  durability: 2\n  deadline:\n    sec: \
            9223372036\n    nsec: 854775807\n  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n  liveliness: 1\n  \
            liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n  avoid_ros_namespace_conventions: \
            false";
        let qos = Qos { reliable: true, depth: 10, transient_local: false };
        assert_eq!(qos.offered_qos_profiles(), expected);
        let latched = Qos { reliable: false, depth: 1, transient_local: true }.offered_qos_profiles();
        assert!(latched.contains("depth: 1\n  reliability: 2\n  durability: 1\n"), "{latched}");
    }
}
