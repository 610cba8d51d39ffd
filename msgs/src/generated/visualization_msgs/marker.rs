// Generated from std/visualization_msgs/msg/Marker.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::builtin_interfaces::Duration;
use crate::generated::geometry_msgs::Point;
use crate::generated::geometry_msgs::Pose;
use crate::generated::geometry_msgs::Vector3;
use crate::generated::sensor_msgs::CompressedImage;
use crate::generated::std_msgs::ColorRGBA;
use crate::generated::std_msgs::Header;
use crate::generated::visualization_msgs::MeshFile;
use crate::generated::visualization_msgs::UVCoordinate;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `visualization_msgs/msg/Marker`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    /// `std_msgs/Header header`.
    pub header: Header,
    /// `string ns`.
    pub ns: String,
    /// `int32 id`.
    pub id: i32,
    /// `int32 type`.
    pub r#type: i32,
    /// `int32 action`.
    pub action: i32,
    /// `geometry_msgs/Pose pose`.
    pub pose: Pose,
    /// `geometry_msgs/Vector3 scale`.
    pub scale: Vector3,
    /// `std_msgs/ColorRGBA color`.
    pub color: ColorRGBA,
    /// `builtin_interfaces/Duration lifetime`.
    pub lifetime: Duration,
    /// `bool frame_locked`.
    pub frame_locked: bool,
    /// `geometry_msgs/Point[] points`.
    pub points: Vec<Point>,
    /// `std_msgs/ColorRGBA[] colors`.
    pub colors: Vec<ColorRGBA>,
    /// `string texture_resource`.
    pub texture_resource: String,
    /// `sensor_msgs/CompressedImage texture`.
    pub texture: CompressedImage,
    /// `visualization_msgs/UVCoordinate[] uv_coordinates`.
    pub uv_coordinates: Vec<UVCoordinate>,
    /// `string text`.
    pub text: String,
    /// `string mesh_resource`.
    pub mesh_resource: String,
    /// `visualization_msgs/MeshFile mesh_file`.
    pub mesh_file: MeshFile,
    /// `bool mesh_use_embedded_materials`.
    pub mesh_use_embedded_materials: bool,
}

impl Marker {
    /// `ARROW`.
    pub const ARROW: i32 = 0;

    /// `CUBE`.
    pub const CUBE: i32 = 1;

    /// `SPHERE`.
    pub const SPHERE: i32 = 2;

    /// `CYLINDER`.
    pub const CYLINDER: i32 = 3;

    /// `LINE_STRIP`.
    pub const LINE_STRIP: i32 = 4;

    /// `LINE_LIST`.
    pub const LINE_LIST: i32 = 5;

    /// `CUBE_LIST`.
    pub const CUBE_LIST: i32 = 6;

    /// `SPHERE_LIST`.
    pub const SPHERE_LIST: i32 = 7;

    /// `POINTS`.
    pub const POINTS: i32 = 8;

    /// `TEXT_VIEW_FACING`.
    pub const TEXT_VIEW_FACING: i32 = 9;

    /// `MESH_RESOURCE`.
    pub const MESH_RESOURCE: i32 = 10;

    /// `TRIANGLE_LIST`.
    pub const TRIANGLE_LIST: i32 = 11;

    /// `ARROW_STRIP`.
    pub const ARROW_STRIP: i32 = 12;

    /// `ADD`.
    pub const ADD: i32 = 0;

    /// `MODIFY`.
    pub const MODIFY: i32 = 0;

    /// `DELETE`.
    pub const DELETE: i32 = 2;

    /// `DELETEALL`.
    pub const DELETEALL: i32 = 3;
}

impl Message for Marker {
    codec!();
    const PACKAGE: &'static str = "visualization_msgs";
    const NAME: &'static str = "Marker";
    const TYPE: &'static str = "visualization_msgs/msg/Marker";
    const HASH: &'static str = "RIHS01_45b13ccf791f225962bf74e746f9644518855d783a6f42ba0cc14fde2b4f3ce0";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "ns" => (17, 0, ""),
        "id" => (6, 0, ""),
        "type" => (6, 0, ""),
        "action" => (6, 0, ""),
        "pose" => (1, 0, "geometry_msgs/msg/Pose"),
        "scale" => (1, 0, "geometry_msgs/msg/Vector3"),
        "color" => (1, 0, "std_msgs/msg/ColorRGBA"),
        "lifetime" => (1, 0, "builtin_interfaces/msg/Duration"),
        "frame_locked" => (15, 0, ""),
        "points" => (145, 0, "geometry_msgs/msg/Point"),
        "colors" => (145, 0, "std_msgs/msg/ColorRGBA"),
        "texture_resource" => (17, 0, ""),
        "texture" => (1, 0, "sensor_msgs/msg/CompressedImage"),
        "uv_coordinates" => (145, 0, "visualization_msgs/msg/UVCoordinate"),
        "text" => (17, 0, ""),
        "mesh_resource" => (17, 0, ""),
        "mesh_file" => (1, 0, "visualization_msgs/msg/MeshFile"),
        "mesh_use_embedded_materials" => (15, 0, ""),
    );
    const DEFINITION: &'static str = definition!(
        "std/visualization_msgs/msg/Marker.msg",
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
