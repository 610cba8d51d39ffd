// Generated from std/geometry_msgs/msg/Quaternion.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `geometry_msgs/msg/Quaternion`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quaternion {
    /// `float64 x 0`.
    pub x: f64,
    /// `float64 y 0`.
    pub y: f64,
    /// `float64 z 0`.
    pub z: f64,
    /// `float64 w 1`.
    pub w: f64,
}

impl Default for Quaternion {
    fn default() -> Self {
        Self { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }
    }
}

impl Message for Quaternion {
    codec!();
    const PACKAGE: &'static str = "geometry_msgs";
    const NAME: &'static str = "Quaternion";
    const TYPE: &'static str = "geometry_msgs/msg/Quaternion";
    const HASH: &'static str = "RIHS01_8a765f66778c8ff7c8ab94afcc590a2ed5325a1d9a076ffff38fbce36f458684";
    const FIELDS: &'static [FieldInfo] = fields!(
        "x" => (11, 0, ""),
        "y" => (11, 0, ""),
        "z" => (11, 0, ""),
        "w" => (11, 0, ""),
    );
    const DEFINITION: &'static str = definition!("std/geometry_msgs/msg/Quaternion.msg");
}
