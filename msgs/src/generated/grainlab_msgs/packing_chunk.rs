// Generated from msg/PackingChunk.msg by examples/generate; not edited by hand.

use crate::cdr::codec;
use crate::message::{FieldInfo, Message, definition, fields};
use serde::{Deserialize, Serialize};

/// A part of a packing that is too large for one sample. The data of all parts in a row are its CDR, encapsulation included.
/// Transport: what is recorded is the whole packing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PackingChunk {
    /// place of the whole among those that this writer sent in parts: 1, 2, 3 ...
    pub body: u64,
    /// bytes of the whole
    pub length: u64,
    /// CRC-32 (IEEE 802.3) of the whole
    pub body_crc: u32,
    /// bytes of every part but the last
    pub stride: u32,
    /// parts of the whole
    pub count: u32,
    /// of this part, from 0; it begins at byte index \* stride
    pub index: u32,
    /// CRC-32 of the six fields above, little endian in a row, and of data
    pub crc: u32,
    /// the part
    pub data: Vec<u8>,
}

impl Message for PackingChunk {
    codec!();
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "PackingChunk";
    const TYPE: &'static str = "grainlab_msgs/msg/PackingChunk";
    const HASH: &'static str = "RIHS01_eb8997168562ddce7f8048fb7f5f25e90707b7ad3cbdd51b4d1a427ba5e83f1c";
    const FIELDS: &'static [FieldInfo] = fields!(
        "body" => (9, 0, ""),
        "length" => (9, 0, ""),
        "body_crc" => (7, 0, ""),
        "stride" => (7, 0, ""),
        "count" => (7, 0, ""),
        "index" => (7, 0, ""),
        "crc" => (7, 0, ""),
        "data" => (147, 0, ""),
    );
    const DEFINITION: &'static str = definition!("msg/PackingChunk.msg");
}
