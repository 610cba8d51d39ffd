//! Framing: one byte of opcode, eight of length, the body.

use mcap::records::{MessageHeader, Record, op};
use std::ops::Range;

use super::lengths;

#[derive(Clone, Copy, Debug)]
pub(crate) struct RawRecord<'a> {
    pub(crate) opcode: u8,
    /// Offset of its opcode from the start of the bytes.
    pub(crate) offset: usize,
    pub(super) body: &'a [u8],
}

/// Bytes before the body.
pub(super) const FRAME: usize = 9;

/// Returns true for a record that MCAP defines and does not allow in a chunk. Later versions and private records may be there.
pub(crate) fn is_misplaced(opcode: u8) -> bool {
    (op::HEADER..=op::DATA_END).contains(&opcode) && ![op::SCHEMA, op::CHANNEL, op::MESSAGE].contains(&opcode)
}

/// Returns true for a type of record that MCAP does not define: one of a later version, or a private one (from 0x80).
pub(crate) fn is_unknown(opcode: u8) -> bool {
    !(op::HEADER..=op::DATA_END).contains(&opcode)
}

pub(super) fn misplaced(opcode: u8) -> String {
    format!("a record of type 0x{opcode:02x} in a chunk, where MCAP does not allow it, is left out")
}

impl<'a> RawRecord<'a> {
    /// Offset of the first byte after the record.
    pub(super) fn end(&self) -> usize {
        self.offset + FRAME + self.body.len()
    }

    /// Returns the parsed record, or the error. Of a key that a map of texts has twice, the last value is taken.
    pub(crate) fn parse(&self) -> Result<Record<'a>, String> {
        self.fit()?;
        let fault = match mcap::parse_record(self.opcode, self.body) {
            Ok(record) => return Ok(record),
            Err(fault) => fault,
        };
        let last = lengths::repeated_key(self.opcode, self.body);
        let last = last.and_then(|(_, body)| Some(mcap::parse_record(self.opcode, &body).ok()?.into_owned()));
        last.ok_or_else(|| match fault {
            mcap::McapError::Parse(_) => format!("not a record of type 0x{:02x}", self.opcode),
            other => other.to_string(),
        })
    }

    /// Checks the lengths in the record, which is enough for a record whose content is not needed.
    pub(super) fn fit(&self) -> Result<(), String> {
        let fault = || format!("the lengths in it do not fit a record of type 0x{:02x}", self.opcode);
        lengths::fit(self.opcode, self.body).then_some(()).ok_or_else(fault)
    }

    /// Describes a key that the metadata of a channel, or a metadata record, has twice.
    pub(super) fn repeated_key(&self) -> Option<String> {
        let (key, _) = lengths::repeated_key(self.opcode, self.body)?;
        let name = match self.parse() {
            Ok(Record::Channel(channel)) => format!("the metadata of channel {:?}", channel.topic),
            Ok(Record::Metadata(metadata)) => format!("the metadata record {:?}", metadata.name),
            _ => format!("a record of type 0x{:02x}", self.opcode),
        };
        let key = String::from_utf8_lossy(key);
        Some(format!(
            "{name} has the key {key:?} twice, and MCAP does not define which value counts; the last one is used"
        ))
    }
}

impl RawRecord<'_> {
    /// Header of a message record, and the position of its data in the bytes from which the record was taken.
    pub(super) fn message(&self) -> Option<(MessageHeader, Range<usize>)> {
        const HEADER: usize = 22;
        if self.opcode != op::MESSAGE {
            return None;
        }
        let (h, _) = self.body.split_first_chunk::<HEADER>()?;
        let eight = |at: usize| u64::from_le_bytes(std::array::from_fn(|n| h[at + n]));
        let header = MessageHeader {
            channel_id: u16::from_le_bytes([h[0], h[1]]),
            sequence: u32::from_le_bytes([h[2], h[3], h[4], h[5]]),
            log_time: eight(6),
            publish_time: eight(14),
        };
        Some((header, self.offset + FRAME + HEADER..self.end()))
    }
}

/// Iterates over records; ends at the end of the bytes, or with the offset of an incomplete record.
pub(super) struct Records<'a> {
    bytes: &'a [u8],
    position: usize,
}

impl<'a> Records<'a> {
    pub(super) fn new(bytes: &'a [u8], position: usize) -> Self {
        Self { bytes, position }
    }

    pub(super) fn at(bytes: &'a [u8], offset: u64) -> Option<RawRecord<'a>> {
        let offset = usize::try_from(offset).ok()?;
        Records::new(bytes, offset).next()?.ok()
    }
}

impl<'a> Iterator for Records<'a> {
    type Item = Result<RawRecord<'a>, usize>;

    fn next(&mut self) -> Option<Self::Item> {
        let offset = self.position;
        let rest = self.bytes.get(offset..).filter(|rest| !rest.is_empty())?;
        // An invalid frame ends the iteration: the start of the next record is unknown.
        self.position = self.bytes.len();
        let frame = rest.split_first().and_then(|(opcode, rest)| Some((*opcode, rest.first_chunk::<8>()?)));
        let Some((opcode, length)) = frame else { return Some(Err(offset)) };
        let body = usize::try_from(u64::from_le_bytes(*length)).ok().and_then(|n| rest[FRAME..].get(..n));
        let Some(body) = body else { return Some(Err(offset)) };
        let record = RawRecord { opcode, offset, body };
        self.position = record.end();
        Some(Ok(record))
    }
}
