// Generated from std/sensor_msgs/msg/PointField.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `sensor_msgs/msg/PointField`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointField {
    /// `string name`.
    pub name: String,
    /// `uint32 offset`.
    pub offset: u32,
    /// `uint8 datatype`.
    pub datatype: u8,
    /// `uint32 count`.
    pub count: u32,
}

impl PointField {
    /// `INT8`.
    pub const INT8: u8 = 1;

    /// `UINT8`.
    pub const UINT8: u8 = 2;

    /// `INT16`.
    pub const INT16: u8 = 3;

    /// `UINT16`.
    pub const UINT16: u8 = 4;

    /// `INT32`.
    pub const INT32: u8 = 5;

    /// `UINT32`.
    pub const UINT32: u8 = 6;

    /// `FLOAT32`.
    pub const FLOAT32: u8 = 7;

    /// `FLOAT64`.
    pub const FLOAT64: u8 = 8;
}

impl Message for PointField {
    codec!();
    const PACKAGE: &'static str = "sensor_msgs";
    const NAME: &'static str = "PointField";
    const TYPE: &'static str = "sensor_msgs/msg/PointField";
    const HASH: &'static str = "RIHS01_5c6a4750728c2bcfbbf7037225b20b02d4429634732146b742dee1726637ef01";
    const FIELDS: &'static [FieldInfo] = fields!(
        "name" => (17, 0, ""),
        "offset" => (7, 0, ""),
        "datatype" => (3, 0, ""),
        "count" => (7, 0, ""),
    );
    const DEFINITION: &'static str = definition!("std/sensor_msgs/msg/PointField.msg");
}
