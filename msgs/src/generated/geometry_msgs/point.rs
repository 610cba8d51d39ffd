// Generated from std/geometry_msgs/msg/Point.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `geometry_msgs/msg/Point`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// `float64 x`.
    pub x: f64,
    /// `float64 y`.
    pub y: f64,
    /// `float64 z`.
    pub z: f64,
}

impl Message for Point {
    codec!();
    const PACKAGE: &'static str = "geometry_msgs";
    const NAME: &'static str = "Point";
    const TYPE: &'static str = "geometry_msgs/msg/Point";
    const HASH: &'static str = "RIHS01_6963084842a9b04494d6b2941d11444708d892da2f4b09843b9c43f42a7f6881";
    const FIELDS: &'static [FieldInfo] = fields!(
        "x" => (11, 0, ""),
        "y" => (11, 0, ""),
        "z" => (11, 0, ""),
    );
    const DEFINITION: &'static str = definition!("std/geometry_msgs/msg/Point.msg");
}
