// Generated from msg/Waveform.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::geometry_msgs::Vector3;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The traces of one wave behind a WaveSpeeds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Waveform {
    /// copied from the Packing probed, or the instrument's time
    pub header: Header,
    /// step of the Packing probed, 0 = not from a simulation
    pub source_step: u64,
    /// what they are evaluated for, one of WaveSpeed.METHOD_\*
    pub method: u8,
    /// unit propagation direction
    pub direction: Vector3,
    /// unit particle motion, sent and received
    pub polarization: Vector3,
    /// Hz, dominant, sent
    pub frequency: f64,
    /// Hz
    pub sample_rate: f64,
    /// s, of the first sample after the trigger
    pub start: f64,
    /// "velocity", of the particles along the polarization
    pub quantity: String,
    /// UCUM, "m/s"
    pub unit: String,
    /// trace names, one or more
    pub channel: Vec<String>,
    /// m, from the source, one per channel; of a standing wave its wavelength
    pub distance: Vec<f64>,
    /// unit above, channel-major, as many in each channel
    pub sample: Vec<f32>,
}

impl Message for Waveform {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Waveform";
    const TYPE: &'static str = "grainlab_msgs/msg/Waveform";
    const HASH: &'static str = "RIHS01_b3a83380ea40c914f3d9e392d8cc5ddf60b466010f45cffae0ef6006334fc79e";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "source_step" => (9, 0, ""),
        "method" => (3, 0, ""),
        "direction" => (1, 0, "geometry_msgs/msg/Vector3"),
        "polarization" => (1, 0, "geometry_msgs/msg/Vector3"),
        "frequency" => (11, 0, ""),
        "sample_rate" => (11, 0, ""),
        "start" => (11, 0, ""),
        "quantity" => (17, 0, ""),
        "unit" => (17, 0, ""),
        "channel" => (161, 0, ""),
        "distance" => (155, 0, ""),
        "sample" => (154, 0, ""),
    );
    const DEFINITION: &'static str = definition!(
        "msg/Waveform.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
