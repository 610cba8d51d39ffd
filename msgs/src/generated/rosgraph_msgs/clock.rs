// Generated from std/rosgraph_msgs/msg/Clock.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::builtin_interfaces::Time;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `rosgraph_msgs/msg/Clock`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    /// `builtin_interfaces/Time clock`.
    pub clock: Time,
}

impl Message for Clock {
    codec!();
    const PACKAGE: &'static str = "rosgraph_msgs";
    const NAME: &'static str = "Clock";
    const TYPE: &'static str = "rosgraph_msgs/msg/Clock";
    const HASH: &'static str = "RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564";
    const FIELDS: &'static [FieldInfo] = fields!(
        "clock" => (1, 0, "builtin_interfaces/msg/Time"),
    );
    const DEFINITION: &'static str = definition!(
        "std/rosgraph_msgs/msg/Clock.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
