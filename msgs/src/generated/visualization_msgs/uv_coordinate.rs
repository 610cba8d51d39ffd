// Generated from std/visualization_msgs/msg/UVCoordinate.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `visualization_msgs/msg/UVCoordinate`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UVCoordinate {
    /// `float32 u`.
    pub u: f32,
    /// `float32 v`.
    pub v: f32,
}

impl Message for UVCoordinate {
    codec!();
    const PACKAGE: &'static str = "visualization_msgs";
    const NAME: &'static str = "UVCoordinate";
    const TYPE: &'static str = "visualization_msgs/msg/UVCoordinate";
    const HASH: &'static str = "RIHS01_f27f7ed21fe360c6066944f856b801a0c0d1e94e815b6886444b42d90b196a26";
    const FIELDS: &'static [FieldInfo] = fields!(
        "u" => (10, 0, ""),
        "v" => (10, 0, ""),
    );
    const DEFINITION: &'static str = definition!("std/visualization_msgs/msg/UVCoordinate.msg");
}
