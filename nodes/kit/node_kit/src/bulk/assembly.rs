//! Assembles the parts of one body.

use super::part::{PartError, Shape};
use grainlab_msgs::msg::PackingChunk;

/// Maximum number of parts kept beyond the first missing one: as many as a credit has bits for.
const AHEAD: u32 = u64::BITS;

/// An incomplete body. Memory is allocated only for received parts and for gaps of a few parts.
#[derive(Debug)]
pub(super) struct Assembly {
    pub(super) shape: Shape,
    bytes: Vec<u8>,
    /// First missing part.
    next: u32,
    /// Bit i: part `next + 1 + i` is held.
    held: u64,
}

impl Assembly {
    pub(super) fn new(shape: Shape) -> Self {
        Self { shape, bytes: Vec::new(), next: 0, held: 0 }
    }

    /// The first missing part, and a bit for each of the 64 parts after it: whether it is held.
    pub(super) fn credit(&self) -> (u32, u64) {
        (self.next, self.held)
    }

    pub(super) fn parts(&self) -> u64 {
        u64::from(self.next) + u64::from(self.held.count_ones())
    }

    /// Adds a part, already checked on its own. Returns true if it is new.
    pub(super) fn add(&mut self, part: &PackingChunk, shape: &Shape) -> Result<bool, PartError> {
        let PackingChunk { body, index, .. } = *part;
        if *shape != self.shape {
            return Err(PartError(format!(
                "part {index} of body {body} contradicts earlier parts in length, body_crc, stride or count"
            )));
        }
        // A part too far ahead is requested again later.
        let Some(ahead) = index.checked_sub(self.next).filter(|ahead| *ahead <= AHEAD) else {
            return Ok(false);
        };
        if ahead > 0 && self.held >> (ahead - 1) & 1 == 1 {
            return Ok(false);
        }
        let start = self.shape.start_of(index);
        let end = start + part.data.len();
        if self.bytes.len() < end {
            self.bytes.resize(end, 0);
        }
        self.bytes[start..end].copy_from_slice(&part.data);
        if ahead > 0 {
            self.held |= 1 << (ahead - 1);
        } else {
            // The gap is closed: advance past this part and past the held ones that follow it.
            let waited = self.held.trailing_ones();
            self.next += 1 + waited;
            self.held = self.held.checked_shr(waited + 1).unwrap_or(0);
        }
        Ok(true)
    }

    pub(super) fn is_complete(&self) -> bool {
        self.next == self.shape.count
    }

    /// The complete body, or its CRC if this is not the CRC that the parts state.
    pub(super) fn into_body(self) -> Result<Vec<u8>, u32> {
        let found = crc32fast::hash(&self.bytes);
        if found == self.shape.body_crc { Ok(self.bytes) } else { Err(found) }
    }
}
