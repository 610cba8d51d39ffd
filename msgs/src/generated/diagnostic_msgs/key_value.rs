// Generated from std/diagnostic_msgs/msg/KeyValue.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `diagnostic_msgs/msg/KeyValue`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct KeyValue {
    /// `string key`.
    pub key: String,
    /// `string value`.
    pub value: String,
}

impl Message for KeyValue {
    codec!();
    const PACKAGE: &'static str = "diagnostic_msgs";
    const NAME: &'static str = "KeyValue";
    const TYPE: &'static str = "diagnostic_msgs/msg/KeyValue";
    const HASH: &'static str = "RIHS01_d68081eaa540288c5440753baecef0c4e16e81a5f78ad68902ded5100413bb42";
    const FIELDS: &'static [FieldInfo] = fields!(
        "key" => (17, 0, ""),
        "value" => (17, 0, ""),
    );
    const DEFINITION: &'static str = definition!("std/diagnostic_msgs/msg/KeyValue.msg");
}
