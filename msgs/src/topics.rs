//! The contract: every topic with its type, QoS and writer. Topics are named only here.

use crate::message::{Message, TypeInfo};
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
        !self.is_transport() && ![STRESS_SAMPLED.name, PACKING_SAMPLED.name].contains(&self.name)
    }

    /// True if it carries only parts of another topic's messages: it is never recorded, but the whole
    /// messages are.
    pub fn is_transport(&self) -> bool {
        self.info == PACKING_CHUNK.info || self.info == PACKING_CREDIT.info
    }
}

const fn row<T: Message>(name: &'static str, qos: Qos, writer: &'static str) -> Topic {
    Topic { name, info: TypeInfo::of::<T>(), qos, writer, reproducible: false }
}

/// Row of a topic of which every recorded byte is a function of scene and seed.
const fn exact<T: Message>(name: &'static str, qos: Qos, writer: &'static str) -> Topic {
    Topic { reproducible: true, ..row::<T>(name, qos, writer) }
}

/// Requests to the servo, one for each exchange of the lockstep: stress, setpoints, clamps, tangent stiffness.
pub const STRESS: Topic = exact::<msg::Stress>("stress", Qos::STREAM, "dem_simulator");

/// Some of the requests on [`STRESS`], for viewers: reading all of them costs a run time. They are never recorded.
pub const STRESS_SAMPLED: Topic = row::<msg::Stress>("stress_sampled", Qos::SAMPLED, "dem_simulator");

/// Answers of the servo: six strain rates for one request.
pub const STRAIN_RATE: Topic = exact::<msg::StrainRate>("strain_rate", Qos::STREAM, "servo_controller");

/// The complete mechanical state: grains, contacts, loading path.
pub const PACKING: Topic = exact::<msg::Packing>("packing", Qos::LATCHED, "dem_simulator");

/// The state now and then, for viewers, while somebody reads it: which states follows from clocks. They are never recorded.
pub const PACKING_SAMPLED: Topic =
    row::<msg::Packing>("packing_sampled", Qos { depth: 1, ..Qos::SAMPLED }, "dem_simulator");

/// Parts of packings that are too large for one sample of [`PACKING`]. Recorders write the whole packing.
pub const PACKING_CHUNK: Topic = row::<msg::PackingChunk>("packing_chunk", Qos::PARTS, "dem_simulator");

/// The parts that each reader of packings has.
pub const PACKING_CREDIT: Topic =
    row::<msg::PackingCredit>("packing_credit", Qos::PARTS, "every reader of packings");

/// Everything that is measured on a packing: structure, stress, stiffness.
pub const PACKING_REPORT: Topic =
    exact::<msg::PackingReport>("packing_report", Qos::LATCHED, "fabric_analyzer");

/// Moduli of a sample, and the other inputs of an inversion: written only by instruments and other programs.
pub const MODULI: Topic = exact::<msg::Moduli>("moduli", Qos::LATCHED, "an instrument");

/// Wave speeds by direction and polarisation, real or virtual: an instrument may write them, too.
pub const WAVE_SPEEDS: Topic = exact::<msg::WaveSpeeds>("wave_speeds", Qos::LATCHED, "acoustic_probe");

/// Traces of the wave speeds, one message per wave.
pub const WAVEFORM: Topic = exact::<msg::Waveform>("waveform", Qos::LATCHED_SET, "acoustic_probe");

/// Inferred microstructure of a packing, one estimate for each model.
pub const MICROSTRUCTURE: Topic =
    exact::<msg::Microstructure>("microstructure", Qos::LATCHED, "emt_inversion");

/// Phase and progress of the run, and the step of the last packing.
pub const RUN_STATE: Topic = row::<msg::RunState>("run_state", Qos::LATCHED, "dem_simulator");

/// Energy balance of a phase, one message per phase, if the scene asks for it.
pub const ENERGY: Topic = row::<msg::EnergyBalance>("energy", Qos::LATCHED_SET, "dem_simulator");

/// Simulated time, with each sampled request, for tools; no node of grainlab waits for it.
pub const CLOCK: Topic = row::<rosgraph_msgs::Clock>("/clock", Qos::CLOCK, "dem_simulator");

/// Lines of the logs of all nodes.
pub const ROSOUT: Topic = row::<rcl_interfaces::Log>("/rosout", Qos::ROSOUT, "every node");

/// Health and counters of every node. Deeper than ROS 2's 10, so that a recording is complete.
pub const DIAGNOSTICS: Topic =
    row::<diagnostic_msgs::DiagnosticArray>("/diagnostics", Qos::STREAM, "every node");

/// Frame of the cell, for viewers.
pub const TF_STATIC: Topic = row::<tf2_msgs::TFMessage>("/tf_static", Qos::LATCHED, "dem_simulator");

/// Grains of the packing as points, for viewers.
pub const PACKING_POINTS: Topic =
    exact::<sensor_msgs::PointCloud2>("packing/points", Qos::LATCHED, "packing_pictures");

/// Grains, contacts and cell of the packing as markers, for viewers.
pub const PACKING_MARKERS: Topic =
    exact::<visualization_msgs::MarkerArray>("packing/markers", Qos::LATCHED, "packing_pictures");

/// Pictures of the packing. They follow from [`PACKING`] at any time, so that a run does not record them.
pub const PICTURES: &[Topic] = &[PACKING_POINTS, PACKING_MARKERS];

/// Every topic of a run.
pub const TOPICS: &[Topic] = &[
    STRESS,
    STRESS_SAMPLED,
    STRAIN_RATE,
    PACKING,
    PACKING_SAMPLED,
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
