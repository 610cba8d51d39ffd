// Generated from msg/PackingCredit.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// What one reader holds of a packing that one writer sends in parts, and whether it takes more. Said on every change and
/// repeated: each credit replaces the one before. Transport: not recorded.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PackingCredit {
    /// GUID of the writer of PackingChunk that is meant; zeros: any, of which nothing is held
    pub writer: [u8; 16],
    /// as in PackingChunk; 0 if nothing came yet
    pub body: u64,
    /// first part that is missing; the count of parts if none is
    pub next: u32,
    /// bit i: part next + 1 + i is held already
    pub held: u64,
    /// whether it takes more; if not, the writer waits
    pub ready: bool,
}

impl Message for PackingCredit {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "PackingCredit";
    const TYPE: &'static str = "grainlab_msgs/msg/PackingCredit";
    const HASH: &'static str = "RIHS01_ae300f49e419eed7e811996cdfa2d0646fee1e95013a0fab7ecf958aac88a6f0";
    const FIELDS: &'static [FieldInfo] = fields!(
        "writer" => (51, 16, ""),
        "body" => (9, 0, ""),
        "next" => (7, 0, ""),
        "held" => (9, 0, ""),
        "ready" => (15, 0, ""),
    );
    const DEFINITION: &'static str = definition!("msg/PackingCredit.msg");
}
