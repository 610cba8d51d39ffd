// Generated from std/builtin_interfaces/msg/Duration.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `builtin_interfaces/msg/Duration`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Duration {
    /// `int32 sec`.
    pub sec: i32,
    /// `uint32 nanosec`.
    pub nanosec: u32,
}

impl Message for Duration {
    codec!();
    const PACKAGE: &'static str = "builtin_interfaces";
    const NAME: &'static str = "Duration";
    const TYPE: &'static str = "builtin_interfaces/msg/Duration";
    const HASH: &'static str = "RIHS01_e8d009f659816f758b75334ee1a9ca5b5c0b859843261f14c7f937349599d93b";
    const FIELDS: &'static [FieldInfo] = fields!(
        "sec" => (6, 0, ""),
        "nanosec" => (7, 0, ""),
    );
    const DEFINITION: &'static str = definition!("std/builtin_interfaces/msg/Duration.msg");
}
