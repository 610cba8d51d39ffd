// Generated from std/geometry_msgs/msg/Transform.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::geometry_msgs::Quaternion;
use crate::generated::geometry_msgs::Vector3;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `geometry_msgs/msg/Transform`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Transform {
    /// `Vector3 translation`.
    pub translation: Vector3,
    /// `Quaternion rotation`.
    pub rotation: Quaternion,
}

impl Message for Transform {
    codec!();
    const PACKAGE: &'static str = "geometry_msgs";
    const NAME: &'static str = "Transform";
    const TYPE: &'static str = "geometry_msgs/msg/Transform";
    const HASH: &'static str = "RIHS01_beb83fbe698636351461f6f35d1abb20010c43d55374d81bd041f1ba2581fddc";
    const FIELDS: &'static [FieldInfo] = fields!(
        "translation" => (1, 0, "geometry_msgs/msg/Vector3"),
        "rotation" => (1, 0, "geometry_msgs/msg/Quaternion"),
    );
    const DEFINITION: &'static str = definition!(
        "std/geometry_msgs/msg/Transform.msg",
        "geometry_msgs/Quaternion" => "std/geometry_msgs/msg/Quaternion.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
    );
}
