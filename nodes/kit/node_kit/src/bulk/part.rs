//! One part of a body.

use super::limits::{LONGEST, STRIDE};
use grainlab_msgs::msg::PackingChunk;

/// Largest part that a reader accepts, bytes: it holds some dozens of them out of order.
const LONGEST_PART: u32 = 1 << 20;

/// Why a part, or the body assembled from parts, is refused. The part is requested again.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub(crate) struct PartError(pub(super) String);

/// The fields that all parts of one body share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    pub(super) body: u64,
    pub(super) length: u64,
    pub(super) body_crc: u32,
    pub(super) stride: u32,
    pub(super) count: u32,
}

impl Shape {
    pub(super) fn of(body: u64, bytes: &[u8]) -> Self {
        Self {
            body,
            length: bytes.len() as u64,
            body_crc: crc32fast::hash(bytes),
            stride: STRIDE as u32,
            count: u32::try_from(bytes.len().div_ceil(STRIDE)).unwrap_or(u32::MAX),
        }
    }

    /// Fails if the part is corrupt, or its fields are inconsistent.
    pub(super) fn checked(part: &PackingChunk) -> Result<Self, PartError> {
        let (body, index) = (part.body, part.index);
        let found = crc_of(part);
        if found != part.crc {
            return Err(PartError(format!(
                "part {index} of body {body} is corrupt: its CRC is {found:08x}, and its field crc is {:08x}",
                part.crc
            )));
        }
        if !(1..=LONGEST).contains(&part.length) {
            let length = part.length;
            return Err(PartError(format!("body {body} has length = {length}: it must be 1 to {LONGEST}")));
        }
        let shape = |field: &str, found: u64, expected: String| {
            Err(PartError(format!(
                "part {index} of body {body} has {field} = {found}: it must be {expected}"
            )))
        };
        if !(1..=LONGEST_PART).contains(&part.stride) {
            return shape("stride", u64::from(part.stride), format!("1 to {LONGEST_PART}"));
        }
        let count = part.length.div_ceil(u64::from(part.stride));
        if u64::from(part.count) != count {
            return shape("count", u64::from(part.count), count.to_string());
        }
        if u64::from(index) >= count {
            return shape("index", u64::from(index), format!("less than {count}"));
        }
        if body == 0 {
            return shape("body", 0, "1 or more".into());
        }
        let PackingChunk { length, body_crc, stride, .. } = *part;
        let this = Self { body, length, body_crc, stride, count: part.count };
        let expected = this.bytes_of(index);
        if part.data.len() != expected {
            return shape("data length", part.data.len() as u64, expected.to_string());
        }
        Ok(this)
    }

    /// Offset of a part in the body, bytes.
    pub(super) fn start_of(&self, index: u32) -> usize {
        index as usize * self.stride as usize
    }

    /// Size of a part, bytes.
    pub(super) fn bytes_of(&self, index: u32) -> usize {
        (self.length as usize - self.start_of(index)).min(self.stride as usize)
    }

    pub(super) fn cut(&self, bytes: &[u8], index: u32) -> PackingChunk {
        let start = self.start_of(index);
        let mut part = PackingChunk {
            body: self.body,
            length: self.length,
            body_crc: self.body_crc,
            stride: self.stride,
            count: self.count,
            index,
            crc: 0,
            data: bytes[start..start + self.bytes_of(index)].to_vec(),
        };
        part.crc = crc_of(&part);
        part
    }
}

pub(super) fn crc_of(part: &PackingChunk) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    crc.update(&part.body.to_le_bytes());
    crc.update(&part.length.to_le_bytes());
    for field in [part.body_crc, part.stride, part.count, part.index] {
        crc.update(&field.to_le_bytes());
    }
    crc.update(&part.data);
    crc.finalize()
}
