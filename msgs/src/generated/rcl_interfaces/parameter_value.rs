// Generated from std/rcl_interfaces/msg/ParameterValue.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `rcl_interfaces/msg/ParameterValue`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterValue {
    /// `uint8 type`.
    pub r#type: u8,
    /// `bool bool_value`.
    pub bool_value: bool,
    /// `int64 integer_value`.
    pub integer_value: i64,
    /// `float64 double_value`.
    pub double_value: f64,
    /// `string string_value`.
    pub string_value: String,
    /// `byte[] byte_array_value`.
    pub byte_array_value: Vec<u8>,
    /// `bool[] bool_array_value`.
    pub bool_array_value: Vec<bool>,
    /// `int64[] integer_array_value`.
    pub integer_array_value: Vec<i64>,
    /// `float64[] double_array_value`.
    pub double_array_value: Vec<f64>,
    /// `string[] string_array_value`.
    pub string_array_value: Vec<String>,
}

impl Message for ParameterValue {
    codec!();
    const PACKAGE: &'static str = "rcl_interfaces";
    const NAME: &'static str = "ParameterValue";
    const TYPE: &'static str = "rcl_interfaces/msg/ParameterValue";
    const HASH: &'static str = "RIHS01_115fc089a387e23c7ecd3525c9189c379109119d6ab82e8dfbde0fdf6a7f9b68";
    const FIELDS: &'static [FieldInfo] = fields!(
        "type" => (3, 0, ""),
        "bool_value" => (15, 0, ""),
        "integer_value" => (8, 0, ""),
        "double_value" => (11, 0, ""),
        "string_value" => (17, 0, ""),
        "byte_array_value" => (160, 0, ""),
        "bool_array_value" => (159, 0, ""),
        "integer_array_value" => (152, 0, ""),
        "double_array_value" => (155, 0, ""),
        "string_array_value" => (161, 0, ""),
    );
    const DEFINITION: &'static str = definition!("std/rcl_interfaces/msg/ParameterValue.msg");
}
