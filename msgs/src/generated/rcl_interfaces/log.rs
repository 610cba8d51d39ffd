// Generated from std/rcl_interfaces/msg/Log.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::generated::builtin_interfaces::Time;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `rcl_interfaces/msg/Log`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Log {
    /// `builtin_interfaces/Time stamp`.
    pub stamp: Time,
    /// `uint8 level`.
    pub level: u8,
    /// `string name`.
    pub name: String,
    /// `string msg`.
    pub msg: String,
    /// `string file`.
    pub file: String,
    /// `string function`.
    pub function: String,
    /// `uint32 line`.
    pub line: u32,
}

impl Log {
    /// `DEBUG`.
    pub const DEBUG: u8 = 10;

    /// `INFO`.
    pub const INFO: u8 = 20;

    /// `WARN`.
    pub const WARN: u8 = 30;

    /// `ERROR`.
    pub const ERROR: u8 = 40;

    /// `FATAL`.
    pub const FATAL: u8 = 50;
}

impl Message for Log {
    codec!();
    const PACKAGE: &'static str = "rcl_interfaces";
    const NAME: &'static str = "Log";
    const TYPE: &'static str = "rcl_interfaces/msg/Log";
    const HASH: &'static str = "RIHS01_e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac";
    const FIELDS: &'static [FieldInfo] = fields!(
        "stamp" => (1, 0, "builtin_interfaces/msg/Time"),
        "level" => (3, 0, ""),
        "name" => (17, 0, ""),
        "msg" => (17, 0, ""),
        "file" => (17, 0, ""),
        "function" => (17, 0, ""),
        "line" => (7, 0, ""),
    );
    const DEFINITION: &'static str = definition!(
        "std/rcl_interfaces/msg/Log.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
