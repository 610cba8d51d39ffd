// Generated from std/visualization_msgs/msg/MeshFile.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `visualization_msgs/msg/MeshFile`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeshFile {
    /// `string filename`.
    pub filename: String,
    /// `uint8[] data`.
    pub data: Vec<u8>,
}

impl Message for MeshFile {
    codec!();
    const PACKAGE: &'static str = "visualization_msgs";
    const NAME: &'static str = "MeshFile";
    const TYPE: &'static str = "visualization_msgs/msg/MeshFile";
    const HASH: &'static str = "RIHS01_7710ece15a148fb7c9b546364cfb215bb06098087bd6394fe5b73a493508f8c4";
    const FIELDS: &'static [FieldInfo] = fields!(
        "filename" => (17, 0, ""),
        "data" => (147, 0, ""),
    );
    const DEFINITION: &'static str = definition!("std/visualization_msgs/msg/MeshFile.msg");
}
