// Generated from std/builtin_interfaces/msg/Time.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `builtin_interfaces/msg/Time`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Time {
    /// `int32 sec`.
    pub sec: i32,
    /// `uint32 nanosec`.
    pub nanosec: u32,
}

impl Message for Time {
    codec!();
    const PACKAGE: &'static str = "builtin_interfaces";
    const NAME: &'static str = "Time";
    const TYPE: &'static str = "builtin_interfaces/msg/Time";
    const HASH: &'static str = "RIHS01_b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197";
    const FIELDS: &'static [FieldInfo] = fields!(
        "sec" => (6, 0, ""),
        "nanosec" => (7, 0, ""),
    );
    const DEFINITION: &'static str = definition!("std/builtin_interfaces/msg/Time.msg");
}
