// Generated from std/visualization_msgs/msg/MarkerArray.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::visualization_msgs::Marker;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `visualization_msgs/msg/MarkerArray`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MarkerArray {
    /// `visualization_msgs/Marker[] markers`.
    pub markers: Vec<Marker>,
}

impl Message for MarkerArray {
    codec!();
    const PACKAGE: &'static str = "visualization_msgs";
    const NAME: &'static str = "MarkerArray";
    const TYPE: &'static str = "visualization_msgs/msg/MarkerArray";
    const HASH: &'static str = "RIHS01_86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf";
    const FIELDS: &'static [FieldInfo] = fields!(
        "markers" => (145, 0, "visualization_msgs/msg/Marker"),
    );
    const DEFINITION: &'static str = definition!(
        "std/visualization_msgs/msg/MarkerArray.msg",
        "visualization_msgs/Marker" => "std/visualization_msgs/msg/Marker.msg",
        "builtin_interfaces/Duration" => "std/builtin_interfaces/msg/Duration.msg",
        "geometry_msgs/Point" => "std/geometry_msgs/msg/Point.msg",
        "geometry_msgs/Pose" => "std/geometry_msgs/msg/Pose.msg",
        "geometry_msgs/Quaternion" => "std/geometry_msgs/msg/Quaternion.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
        "sensor_msgs/CompressedImage" => "std/sensor_msgs/msg/CompressedImage.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
        "std_msgs/ColorRGBA" => "std/std_msgs/msg/ColorRGBA.msg",
        "visualization_msgs/MeshFile" => "std/visualization_msgs/msg/MeshFile.msg",
        "visualization_msgs/UVCoordinate" => "std/visualization_msgs/msg/UVCoordinate.msg",
    );
}
