// Generated from std/diagnostic_msgs/msg/DiagnosticStatus.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::diagnostic_msgs::KeyValue;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `diagnostic_msgs/msg/DiagnosticStatus`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DiagnosticStatus {
    /// `byte level`.
    pub level: u8,
    /// `string name`.
    pub name: String,
    /// `string message`.
    pub message: String,
    /// `string hardware_id`.
    pub hardware_id: String,
    /// `KeyValue[] values`.
    pub values: Vec<KeyValue>,
}

impl DiagnosticStatus {
    /// `OK`.
    pub const OK: u8 = 0;

    /// `WARN`.
    pub const WARN: u8 = 1;

    /// `ERROR`.
    pub const ERROR: u8 = 2;

    /// `STALE`.
    pub const STALE: u8 = 3;
}

impl Message for DiagnosticStatus {
    codec!();
    const PACKAGE: &'static str = "diagnostic_msgs";
    const NAME: &'static str = "DiagnosticStatus";
    const TYPE: &'static str = "diagnostic_msgs/msg/DiagnosticStatus";
    const HASH: &'static str = "RIHS01_b0e3e692ea2d54a8af2f4ef1930e81556a2db55216b771f8a7d2724ed47bf0e4";
    const FIELDS: &'static [FieldInfo] = fields!(
        "level" => (16, 0, ""),
        "name" => (17, 0, ""),
        "message" => (17, 0, ""),
        "hardware_id" => (17, 0, ""),
        "values" => (145, 0, "diagnostic_msgs/msg/KeyValue"),
    );
    const DEFINITION: &'static str = definition!(
        "std/diagnostic_msgs/msg/DiagnosticStatus.msg",
        "diagnostic_msgs/KeyValue" => "std/diagnostic_msgs/msg/KeyValue.msg",
    );
}
