// Generated from std/std_msgs/msg/ColorRGBA.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// The standard message `std_msgs/msg/ColorRGBA`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ColorRGBA {
    /// `float32 r`.
    pub r: f32,
    /// `float32 g`.
    pub g: f32,
    /// `float32 b`.
    pub b: f32,
    /// `float32 a`.
    pub a: f32,
}

impl Message for ColorRGBA {
    codec!();
    const PACKAGE: &'static str = "std_msgs";
    const NAME: &'static str = "ColorRGBA";
    const TYPE: &'static str = "std_msgs/msg/ColorRGBA";
    const HASH: &'static str = "RIHS01_77a7a5b9ae477306097665106e0413ba74440245b1f3d0c6d6405fe5c7813fe8";
    const FIELDS: &'static [FieldInfo] = fields!(
        "r" => (10, 0, ""),
        "g" => (10, 0, ""),
        "b" => (10, 0, ""),
        "a" => (10, 0, ""),
    );
    const DEFINITION: &'static str = definition!("std/std_msgs/msg/ColorRGBA.msg");
}
