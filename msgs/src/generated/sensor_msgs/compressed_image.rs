// Generated from std/sensor_msgs/msg/CompressedImage.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `sensor_msgs/msg/CompressedImage`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CompressedImage {
    /// `std_msgs/Header header`.
    pub header: Header,
    /// `string format`.
    pub format: String,
    /// `uint8[] data`.
    pub data: Vec<u8>,
}

impl Message for CompressedImage {
    codec!();
    const PACKAGE: &'static str = "sensor_msgs";
    const NAME: &'static str = "CompressedImage";
    const TYPE: &'static str = "sensor_msgs/msg/CompressedImage";
    const HASH: &'static str = "RIHS01_15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "format" => (17, 0, ""),
        "data" => (147, 0, ""),
    );
    const DEFINITION: &'static str = definition!(
        "std/sensor_msgs/msg/CompressedImage.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
