// Generated from std/geometry_msgs/msg/TransformStamped.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::geometry_msgs::Transform;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `geometry_msgs/msg/TransformStamped`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TransformStamped {
    /// `std_msgs/Header header`.
    pub header: Header,
    /// `string child_frame_id`.
    pub child_frame_id: String,
    /// `Transform transform`.
    pub transform: Transform,
}

impl Message for TransformStamped {
    codec!();
    const PACKAGE: &'static str = "geometry_msgs";
    const NAME: &'static str = "TransformStamped";
    const TYPE: &'static str = "geometry_msgs/msg/TransformStamped";
    const HASH: &'static str = "RIHS01_0a241f87d04668d94099cbb5ba11691d5ad32c2f29682e4eb5653424bd275206";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "child_frame_id" => (17, 0, ""),
        "transform" => (1, 0, "geometry_msgs/msg/Transform"),
    );
    const DEFINITION: &'static str = definition!(
        "std/geometry_msgs/msg/TransformStamped.msg",
        "geometry_msgs/Transform" => "std/geometry_msgs/msg/Transform.msg",
        "geometry_msgs/Quaternion" => "std/geometry_msgs/msg/Quaternion.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
