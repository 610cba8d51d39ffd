// Generated from std/diagnostic_msgs/msg/DiagnosticArray.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::diagnostic_msgs::DiagnosticStatus;
use crate::generated::std_msgs::Header;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `diagnostic_msgs/msg/DiagnosticArray`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DiagnosticArray {
    /// `std_msgs/Header header`.
    pub header: Header,
    /// `DiagnosticStatus[] status`.
    pub status: Vec<DiagnosticStatus>,
}

impl Message for DiagnosticArray {
    codec!();
    const PACKAGE: &'static str = "diagnostic_msgs";
    const NAME: &'static str = "DiagnosticArray";
    const TYPE: &'static str = "diagnostic_msgs/msg/DiagnosticArray";
    const HASH: &'static str = "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e";
    const FIELDS: &'static [FieldInfo] = fields!(
        "header" => (1, 0, "std_msgs/msg/Header"),
        "status" => (145, 0, "diagnostic_msgs/msg/DiagnosticStatus"),
    );
    const DEFINITION: &'static str = definition!(
        "std/diagnostic_msgs/msg/DiagnosticArray.msg",
        "diagnostic_msgs/DiagnosticStatus" => "std/diagnostic_msgs/msg/DiagnosticStatus.msg",
        "diagnostic_msgs/KeyValue" => "std/diagnostic_msgs/msg/KeyValue.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
