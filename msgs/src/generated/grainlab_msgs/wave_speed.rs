// Generated from msg/WaveSpeed.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::geometry_msgs::Vector3;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// One speed of one mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WaveSpeed {
    /// one of METHOD_\*
    pub method: u8,
    /// unit propagation direction
    pub direction: Vector3,
    /// unit particle motion
    pub polarization: Vector3,
    /// m/s, long-wave limit where the method gives it
    pub speed: f64,
    /// m/s, 0 = unknown
    pub speed_stddev: f64,
    /// Hz, dominant; 0 = extrapolated to zero
    pub frequency: f64,
    /// peak
    pub strain_amplitude: f64,
}

impl WaveSpeed {
    /// onset of the first arrival
    pub const METHOD_FIRST_ARRIVAL: u8 = 0;

    /// delay of greatest correlation
    pub const METHOD_CROSS_CORRELATION: u8 = 1;

    /// delay of the peak
    pub const METHOD_PEAK: u8 = 2;

    /// frequency of a standing wave
    pub const METHOD_STANDING_WAVE: u8 = 3;

    /// slope of the dispersion relation
    pub const METHOD_DISPERSION: u8 = 4;
}

impl Message for WaveSpeed {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "WaveSpeed";
    const TYPE: &'static str = "grainlab_msgs/msg/WaveSpeed";
    const HASH: &'static str = "RIHS01_ba27be9cf51b8cc9761c34799d4d2712cd6e8c0b70ef506bf9982bf7d383ceba";
    const FIELDS: &'static [FieldInfo] = fields!(
        "method" => (3, 0, ""),
        "direction" => (1, 0, "geometry_msgs/msg/Vector3"),
        "polarization" => (1, 0, "geometry_msgs/msg/Vector3"),
        "speed" => (11, 0, ""),
        "speed_stddev" => (11, 0, ""),
        "frequency" => (11, 0, ""),
        "strain_amplitude" => (11, 0, ""),
    );
    const DEFINITION: &'static str = definition!(
        "msg/WaveSpeed.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
    );
}
