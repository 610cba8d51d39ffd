// Generated from msg/Waveform.msg by examples/generate; not edited by hand.

use crate::generated::std_msgs::Header;
use crate::message::{Message, definition};
use serde::{Deserialize, Serialize};

/// The traces behind a WaveSpeeds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Waveform {
    /// of the WaveSpeeds it stands behind
    pub header: Header,
    /// "velocity", "displacement"
    pub quantity: String,
    /// UCUM, for example "m/s"
    pub unit: String,
    /// Hz
    pub sample_rate: f64,
    /// trace names
    pub channel: Vec<String>,
    /// m, from the source, one per channel
    pub distance: Vec<f64>,
    /// unit above, channel-major
    pub sample: Vec<f32>,
}

impl Message for Waveform {
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Waveform";
    const TYPE: &'static str = "grainlab_msgs/msg/Waveform";
    const HASH: &'static str = "RIHS01_6a87acc1efdfe5da5407237404aa7bc840dd51e79bfbdcb7a06e0c7579b283a1";
    const DEFINITION: &'static str = definition!(
        "msg/Waveform.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
