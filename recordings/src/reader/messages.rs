//! Messages in order of log time.

use super::chunk;
use super::error::{ReadError, WarningKind};
use super::file::OpenFile;
use super::held::Held;
use super::index::Block;
use super::message::{Message, Payload};
use super::recording::Recording;
use super::records::Records;
use super::selection::Selection;
use mcap::records::{MessageHeader, op};
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};
use std::sync::Arc;

/// Messages of a recording in order of log time.
pub struct Messages<'r> {
    recording: &'r Recording,
    topics: Option<BTreeSet<String>>,
    start: u64,
    end: u64,
    /// Blocks still to read: file and block, the next one last.
    blocks: Vec<(usize, usize)>,
    /// Messages read and not yet returned, the earliest on top. Blocks of one file may overlap in time.
    pending: BinaryHeap<Reverse<Pending>>,
    held: Held,
}

struct Pending {
    /// Log time, file, block offset, position in the block: a total order.
    key: (u64, usize, usize, usize),
    message: Message,
}

impl PartialEq for Pending {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}
impl Eq for Pending {}
impl PartialOrd for Pending {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Pending {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.key.cmp(&other.key)
    }
}

impl Recording {
    /// The messages selected, in order of log time; messages of equal log time in the order of the file.
    ///
    /// # Errors
    /// If a named topic does not exist.
    pub fn messages(&self, selection: &Selection) -> Result<Messages<'_>, ReadError> {
        let topics = match &selection.topics {
            None => None,
            Some(names) => Some(
                names
                    .iter()
                    .map(|n| Ok(self.channel(n)?.topic.clone()))
                    .collect::<Result<BTreeSet<_>, ReadError>>()?,
            ),
        };
        Ok(Messages::new(self, topics, selection.start.unwrap_or(0), selection.end.unwrap_or(u64::MAX)))
    }

    /// The last message on `topic` whose log time is below `time` (ns since 1970).
    ///
    /// # Errors
    /// If the topic does not exist.
    pub fn last_before(&self, topic: &str, time: u64) -> Result<Option<Message>, ReadError> {
        let topic = self.channel(topic)?.topic.clone();
        Ok(last_before(self, &topic, time))
    }
}

impl<'r> Messages<'r> {
    fn new(recording: &'r Recording, topics: Option<BTreeSet<String>>, start: u64, end: u64) -> Self {
        let mut blocks = Vec::new();
        for (f, file) in recording.files.iter().enumerate() {
            let wanted = |b: &Block| b.end >= start && b.start < end && holds(file, b, topics.as_ref());
            blocks
                .extend(file.index.blocks.iter().enumerate().filter(|(_, b)| wanted(b)).map(|(n, _)| (f, n)));
        }
        blocks.sort_by_key(|&(f, n)| Reverse((recording.files[f].index.blocks[n].start, f, n)));
        Self {
            recording,
            topics,
            start,
            end,
            blocks,
            pending: BinaryHeap::new(),
            held: Held::new(recording.size()),
        }
    }

    fn read_block(&mut self, f: usize, n: usize) {
        let file = &self.recording.files[f];
        let block = &file.index.blocks[n];
        if self.held.is_full() {
            let detail = "too many bytes of chunks that claim the same time are in memory already".to_owned();
            return self.recording.warn(file.warning(block.offset, WarningKind::DamagedChunk, detail));
        }
        let (topics, times) = (self.topics.as_ref(), self.start..self.end);
        let pending = &mut self.pending;
        let take = |position: usize, message: Message| {
            if times.contains(&message.log_time) && topics.is_none_or(|t| t.contains(&message.channel.topic))
            {
                pending
                    .push(Reverse(Pending { key: (message.log_time, f, block.offset, position), message }));
            }
        };
        decode(self.recording, file, block, &self.held, take);
    }
}

impl Iterator for Messages<'_> {
    type Item = Message;

    fn next(&mut self) -> Option<Message> {
        // A block that starts no later than the earliest read message may hold an earlier one.
        while let Some(&(f, n)) = self.blocks.last() {
            let start = self.recording.files[f].index.blocks[n].start;
            if self.pending.peek().is_some_and(|Reverse(p)| p.key.0 < start) {
                break;
            }
            self.blocks.pop();
            self.read_block(f, n);
        }
        self.pending.pop().map(|Reverse(p)| p.message)
    }
}

/// The last message on `topic` before `time`.
fn last_before(recording: &Recording, topic: &str, time: u64) -> Option<Message> {
    let topics = BTreeSet::from([topic.to_owned()]);
    let mut best: Option<Message> = None;
    let mut blocks: Vec<(&OpenFile, &Block)> =
        recording.files.iter().flat_map(|f| f.index.blocks.iter().map(move |b| (f, b))).collect();
    blocks.retain(|(f, b)| b.start < time && holds(f, b, Some(&topics)));
    blocks.sort_by_key(|(_, b)| Reverse(b.end));
    for (file, block) in blocks {
        if best.as_ref().is_some_and(|m| m.log_time >= block.end) {
            break;
        }
        decode(recording, file, block, &Held::new(recording.size()), |_, message| {
            let later = best.as_ref().is_none_or(|b| b.log_time <= message.log_time);
            if message.channel.topic == topic && message.log_time < time && later {
                best = Some(message);
            }
        });
    }
    best
}

fn holds(file: &OpenFile, block: &Block, topics: Option<&BTreeSet<String>>) -> bool {
    let (Some(topics), Some(channels)) = (topics, &block.channels) else { return true };
    channels.iter().any(|c| file.index.channels.get(c).is_some_and(|c| topics.contains(&c.topic)))
}

/// Passes each message of a block to `take`, with its position in the block; an unreadable one becomes a
/// warning.
fn decode(
    recording: &Recording,
    file: &OpenFile,
    block: &Block,
    held: &Held,
    mut take: impl FnMut(usize, Message),
) {
    let damaged = |detail| recording.warn(file.warning(block.offset, WarningKind::DamagedChunk, detail));
    let content = if block.is_chunk {
        let record = Records::at(file.bytes(), block.offset as u64)
            .ok_or_else(|| "it is an incomplete record".to_owned());
        match record.and_then(|r| chunk::content(&r)) {
            Ok(content) => content,
            Err(detail) => return damaged(detail),
        }
    } else {
        file.bytes()[block.offset..block.end_offset].to_vec()
    };
    let content = Arc::new(held.content(content));
    let mut orphans = 0u64;
    for record in Records::new(content.bytes(), 0) {
        let record = match record {
            Ok(record) if record.opcode == op::MESSAGE => record,
            Ok(_) => continue,
            Err(at) => return damaged(format!("an incomplete record starts at byte {at} of its content")),
        };
        let Some((header, range)) = record.message() else {
            damaged(format!("the message at byte {} of its content has an incomplete header", record.offset));
            continue;
        };
        match file.index.channels.get(&header.channel_id) {
            Some(channel) => {
                let (channel, payload) = (channel.clone(), Payload { chunk: content.clone(), range });
                let MessageHeader { sequence, log_time, publish_time, .. } = header;
                take(record.offset, Message { channel, sequence, log_time, publish_time, payload });
            }
            None => orphans += 1,
        }
    }
    if orphans > 0 {
        let detail = format!("{orphans} messages belong to channels whose declaration was lost");
        recording.warn(file.warning(block.offset, WarningKind::Orphans, detail));
    }
}
