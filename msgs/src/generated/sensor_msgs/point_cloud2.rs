// Generated from std/sensor_msgs/msg/PointCloud2.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::sensor_msgs::PointField;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `sensor_msgs/msg/PointCloud2`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointCloud2 {
    /// `std_msgs/Header header`.
    pub header: Header,
    /// `uint32 height`.
    pub height: u32,
    /// `uint32 width`.
    pub width: u32,
    /// `sensor_msgs/PointField[] fields`.
    pub fields: Vec<PointField>,
    /// `bool is_bigendian`.
    pub is_bigendian: bool,
    /// `uint32 point_step`.
    pub point_step: u32,
    /// `uint32 row_step`.
    pub row_step: u32,
    /// `uint8[] data`.
    pub data: Vec<u8>,
    /// `bool is_dense`.
    pub is_dense: bool,
}

impl Message for PointCloud2 {
    codec!();
    const PACKAGE: &'static str = "sensor_msgs";
    const NAME: &'static str = "PointCloud2";
    const TYPE: &'static str = "sensor_msgs/msg/PointCloud2";
    const HASH: &'static str = "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "height" => (7, 0, ""),
        "width" => (7, 0, ""),
        "fields" => (145, 0, "sensor_msgs/msg/PointField"),
        "is_bigendian" => (15, 0, ""),
        "point_step" => (7, 0, ""),
        "row_step" => (7, 0, ""),
        "data" => (147, 0, ""),
        "is_dense" => (15, 0, ""),
    );
    const DEFINITION: &'static str = definition!(
        "std/sensor_msgs/msg/PointCloud2.msg",
        "sensor_msgs/PointField" => "std/sensor_msgs/msg/PointField.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
