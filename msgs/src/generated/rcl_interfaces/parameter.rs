// Generated from std/rcl_interfaces/msg/Parameter.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::rcl_interfaces::ParameterValue;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `rcl_interfaces/msg/Parameter`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// `string name`.
    pub name: String,
    /// `ParameterValue value`.
    pub value: ParameterValue,
}

impl Message for Parameter {
    codec!();
    const PACKAGE: &'static str = "rcl_interfaces";
    const NAME: &'static str = "Parameter";
    const TYPE: &'static str = "rcl_interfaces/msg/Parameter";
    const HASH: &'static str = "RIHS01_ddfe6442cffc462317adb5c92536a7b6dd55858c5c3e1e328165a6b73c2831af";
    const FIELDS: &'static [FieldInfo] = fields!(
        "name" => (17, 0, ""),
        "value" => (1, 0, "rcl_interfaces/msg/ParameterValue"),
    );
    const DEFINITION: &'static str = definition!(
        "std/rcl_interfaces/msg/Parameter.msg",
        "rcl_interfaces/ParameterValue" => "std/rcl_interfaces/msg/ParameterValue.msg",
    );
}
