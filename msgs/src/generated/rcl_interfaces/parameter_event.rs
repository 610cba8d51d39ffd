// Generated from std/rcl_interfaces/msg/ParameterEvent.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::builtin_interfaces::Time;
use crate::generated::rcl_interfaces::Parameter;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `rcl_interfaces/msg/ParameterEvent`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterEvent {
    /// `builtin_interfaces/Time stamp`.
    pub stamp: Time,
    /// `string node`.
    pub node: String,
    /// `Parameter[] new_parameters`.
    pub new_parameters: Vec<Parameter>,
    /// `Parameter[] changed_parameters`.
    pub changed_parameters: Vec<Parameter>,
    /// `Parameter[] deleted_parameters`.
    pub deleted_parameters: Vec<Parameter>,
}

impl Message for ParameterEvent {
    codec!();
    const PACKAGE: &'static str = "rcl_interfaces";
    const NAME: &'static str = "ParameterEvent";
    const TYPE: &'static str = "rcl_interfaces/msg/ParameterEvent";
    const HASH: &'static str = "RIHS01_043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204";
    const FIELDS: &'static [FieldInfo] = fields!(
        "stamp" => (1, 0, "builtin_interfaces/msg/Time"),
        "node" => (17, 0, ""),
        "new_parameters" => (145, 0, "rcl_interfaces/msg/Parameter"),
        "changed_parameters" => (145, 0, "rcl_interfaces/msg/Parameter"),
        "deleted_parameters" => (145, 0, "rcl_interfaces/msg/Parameter"),
    );
    const DEFINITION: &'static str = definition!(
        "std/rcl_interfaces/msg/ParameterEvent.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
        "rcl_interfaces/Parameter" => "std/rcl_interfaces/msg/Parameter.msg",
        "rcl_interfaces/ParameterValue" => "std/rcl_interfaces/msg/ParameterValue.msg",
    );
}
