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

/// Bytes of messages outside chunks that are one block.
const LOOSE_BLOCK: usize = 1 << 20;

/// Adds a message outside chunks to the last block if it follows directly.
pub(super) fn add_loose(blocks: &mut Vec<Block>, record: &RawRecord<'_>, header: &MessageHeader) {
    let (time, channel) = (header.log_time, header.channel_id);
    match blocks.last_mut() {
        Some(last)
            if !last.is_chunk
                && last.end_offset == record.offset
                && record.end() - last.offset <= LOOSE_BLOCK =>
        {
            last.end_offset = record.end();
            (last.start, last.end) = (last.start.min(time), last.end.max(time));
            last.channels.get_or_insert_default().insert(channel);
        }
        _ => blocks.push(Block {
            offset: record.offset,
            end_offset: record.end(),
            start: time,
            end: time,
            channels: Some(BTreeSet::from([channel])),
            is_chunk: false,
        }),
    }
}
