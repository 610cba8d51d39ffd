// Generated from std/tf2_msgs/msg/TFMessage.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::geometry_msgs::TransformStamped;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `tf2_msgs/msg/TFMessage`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TFMessage {
    /// `geometry_msgs/TransformStamped[] transforms`.
    pub transforms: Vec<TransformStamped>,
}

impl Message for TFMessage {
    codec!();
    const PACKAGE: &'static str = "tf2_msgs";
    const NAME: &'static str = "TFMessage";
    const TYPE: &'static str = "tf2_msgs/msg/TFMessage";
    const HASH: &'static str = "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087";
    const FIELDS: &'static [FieldInfo] = fields!(
        "transforms" => (145, 0, "geometry_msgs/msg/TransformStamped"),
    );
    const DEFINITION: &'static str = definition!(
        "std/tf2_msgs/msg/TFMessage.msg",
        "geometry_msgs/TransformStamped" => "std/geometry_msgs/msg/TransformStamped.msg",
        "geometry_msgs/Transform" => "std/geometry_msgs/msg/Transform.msg",
        "geometry_msgs/Quaternion" => "std/geometry_msgs/msg/Quaternion.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
