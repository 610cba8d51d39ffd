// Generated from std/std_msgs/msg/Header.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::builtin_interfaces::Time;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `std_msgs/msg/Header`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// `builtin_interfaces/Time stamp`.
    pub stamp: Time,
    /// `string frame_id`.
    pub frame_id: String,
}

impl Message for Header {
    codec!();
    const PACKAGE: &'static str = "std_msgs";
    const NAME: &'static str = "Header";
    const TYPE: &'static str = "std_msgs/msg/Header";
    const HASH: &'static str = "RIHS01_f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01";
    const FIELDS: &'static [FieldInfo] = fields!(
        "stamp" => (1, 0, "builtin_interfaces/msg/Time"),
        "frame_id" => (17, 0, ""),
    );
    const DEFINITION: &'static str = definition!(
        "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
