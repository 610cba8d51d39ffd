//! One part of a body.

use super::limits::{LONGEST, STRIDE};
use grainlab_msgs::msg::PackingChunk;

/// Longest part that a reader accepts, bytes: it holds some dozens of them out of order.
const LONGEST_PART: u32 = 1 << 20;

/// What is wrong with a part, or with the body that the parts make. The part is refused and asked for again.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PartError {
    /// It is not what was sent.
    #[error("part {index} of body {body} is corrupt: its crc is {found:08x}, and it says {said:08x}")]
    Corrupt {
        /// Which body it says it is of.
        body: u64,
        /// Which part it says it is.
        index: u32,
        /// What its bytes give.
        found: u32,
        /// What it says.
        said: u32,
    },
    /// A length that no body has.
    #[error("body {body} says length = {length}: it must be 1 to {LONGEST}")]
    Length {
        /// Which body.
        body: u64,
        /// The length it says.
        length: u64,
    },
    /// Numbers that do not fit together.
    #[error("part {index} of body {body} says {field} = {found}: it must be {expected}")]
    Shape {
        /// Which body.
        body: u64,
        /// Which part.
        index: u32,
        /// Name of the field.
        field: &'static str,
        /// Its value.
        found: u64,
        /// What it must be, the others being right.
        expected: String,
    },
    /// It contradicts the parts before it.
    #[error(
        "part {index} of body {body} contradicts the parts before it in length, body_crc, stride or count"
    )]
    Contradiction {
        /// Which body.
        body: u64,
        /// Which part.
        index: u32,
    },
    /// All parts are there, and together they are not the body.
    #[error("body {body} is corrupt: its crc is {found:08x}, and the parts say {said:08x}; {what}")]
    Body {
        /// Which body.
        body: u64,
        /// What its bytes give.
        found: u32,
        /// What the parts say.
        said: u32,
        /// What is done about it.
        what: &'static str,
    },
    /// The writer went on to another body.
    #[error("body {body} was given up by its writer when {held} of {count} parts were here")]
    GivenUp {
        /// Which body.
        body: u64,
        /// Parts that had come.
        held: u64,
        /// Parts that it has.
        count: u32,
    },
}

/// What all parts of one body have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    pub(super) body: u64,
    pub(super) length: u64,
    pub(super) body_crc: u32,
    pub(super) stride: u32,
    pub(super) count: u32,
}

impl Shape {
    /// Of a body that is to be sent.
    pub(super) fn of(body: u64, bytes: &[u8]) -> Self {
        Self {
            body,
            length: bytes.len() as u64,
            body_crc: crc32fast::hash(bytes),
            stride: STRIDE as u32,
            count: u32::try_from(bytes.len().div_ceil(STRIDE)).unwrap_or(u32::MAX),
        }
    }

    /// Of the body that a part belongs to, the part being as it was sent and possible.
    pub(super) fn checked(part: &PackingChunk) -> Result<Self, PartError> {
        let (body, index) = (part.body, part.index);
        let found = crc_of(part);
        if found != part.crc {
            return Err(PartError::Corrupt { body, index, found, said: part.crc });
        }
        if !(1..=LONGEST).contains(&part.length) {
            return Err(PartError::Length { body, length: part.length });
        }
        let shape = |field, found, expected| Err(PartError::Shape { body, index, field, found, expected });
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

    /// Where a part begins in the body.
    pub(super) fn start_of(&self, index: u32) -> usize {
        index as usize * self.stride as usize
    }

    /// Bytes of a part.
    pub(super) fn bytes_of(&self, index: u32) -> usize {
        (self.length as usize - self.start_of(index)).min(self.stride as usize)
    }

    /// A part of `bytes`, which this is the shape of.
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

fn crc_of(part: &PackingChunk) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    crc.update(&part.body.to_le_bytes());
    crc.update(&part.length.to_le_bytes());
    for field in [part.body_crc, part.stride, part.count, part.index] {
        crc.update(&field.to_le_bytes());
    }
    crc.update(&part.data);
    crc.finalize()
}
