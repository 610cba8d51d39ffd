//! Blocks of messages, the parts in which a file is read.

use std::collections::BTreeSet;

use mcap::records::MessageHeader;

use super::records::RawRecord;

/// A block of messages: a chunk, or messages outside chunks.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) offset: usize,
    /// First byte after it.
    pub(super) end_offset: usize,
    /// Log time of its first and last message, ns since 1970.
    pub(super) start: u64,
    pub(super) end: u64,
    /// Channels with messages in it; `None` if unknown.
    pub(super) channels: Option<BTreeSet<u16>>,
    pub(super) is_chunk: bool,
}

impl Block {
    pub(super) fn empty(records: &RawRecord<'_>, is_chunk: bool) -> Self {
        let (offset, end_offset, channels) = (records.offset, records.end(), Some(BTreeSet::new()));
        Self { offset, end_offset, start: u64::MAX, end: 0, channels, is_chunk }
    }

    pub(super) fn include(&mut self, header: &MessageHeader) {
        (self.start, self.end) = (self.start.min(header.log_time), self.end.max(header.log_time));
        self.channels.get_or_insert_default().insert(header.channel_id);
    }
}

/// Bytes of messages outside chunks that are one block.
const LOOSE_BLOCK: usize = 1 << 20;

/// Adds a message outside chunks to the last block if it follows directly.
pub(super) fn add_loose(blocks: &mut Vec<Block>, record: &RawRecord<'_>, header: &MessageHeader) {
    let follows = |last: &Block| {
        !last.is_chunk && last.end_offset == record.offset && record.end() - last.offset <= LOOSE_BLOCK
    };
    if !blocks.last().is_some_and(follows) {
        blocks.push(Block::empty(record, false));
    }
    if let Some(last) = blocks.last_mut() {
        last.end_offset = record.end();
        last.include(header);
    }
}
