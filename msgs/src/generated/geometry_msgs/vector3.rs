// Generated from std/geometry_msgs/msg/Vector3.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `geometry_msgs/msg/Vector3`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vector3 {
    /// `float64 x`.
    pub x: f64,
    /// `float64 y`.
    pub y: f64,
    /// `float64 z`.
    pub z: f64,
}

impl Message for Vector3 {
    codec!();
    const PACKAGE: &'static str = "geometry_msgs";
    const NAME: &'static str = "Vector3";
    const TYPE: &'static str = "geometry_msgs/msg/Vector3";
    const HASH: &'static str = "RIHS01_cc12fe83e4c02719f1ce8070bfd14aecd40f75a96696a67a2a1f37f7dbb0765d";
    const FIELDS: &'static [FieldInfo] = fields!(
        "x" => (11, 0, ""),
        "y" => (11, 0, ""),
        "z" => (11, 0, ""),
    );
    const DEFINITION: &'static str = definition!("std/geometry_msgs/msg/Vector3.msg");
}
