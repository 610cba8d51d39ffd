// Generated from std/geometry_msgs/msg/Pose.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::geometry_msgs::Point;
use crate::generated::geometry_msgs::Quaternion;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `geometry_msgs/msg/Pose`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// `geometry_msgs/Point position`.
    pub position: Point,
    /// `geometry_msgs/Quaternion orientation`.
    pub orientation: Quaternion,
}

impl Message for Pose {
    codec!();
    const PACKAGE: &'static str = "geometry_msgs";
    const NAME: &'static str = "Pose";
    const TYPE: &'static str = "geometry_msgs/msg/Pose";
    const HASH: &'static str = "RIHS01_d501954e9476cea2996984e812054b68026ae0bfae789d9a10b23daf35cc90fa";
    const FIELDS: &'static [FieldInfo] = fields!(
        "position" => (1, 0, "geometry_msgs/msg/Point"),
        "orientation" => (1, 0, "geometry_msgs/msg/Quaternion"),
    );
    const DEFINITION: &'static str = definition!(
        "std/geometry_msgs/msg/Pose.msg",
        "geometry_msgs/Point" => "std/geometry_msgs/msg/Point.msg",
        "geometry_msgs/Quaternion" => "std/geometry_msgs/msg/Quaternion.msg",
    );
}
