//! Messages in order of log time.

use super::block::Block;
use super::channel::ChannelInfo;
use super::chunk;
use super::error::WarningKind;
use super::file::OpenFile;
use super::held::Held;
use super::message::{Message, Payload};
use super::recording::Recording;
use super::records::Records;
use super::selection::Selection;
use grainlab_console::{Failure, count};
use mcap::records::{MessageHeader, op};
use std::borrow::Cow;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Messages of a recording in order of log time.
pub struct Messages<'r> {
    recording: &'r Recording,
    topics: Option<BTreeSet<String>>,
    start: u64,
    /// `None`: to the last message, whose time may be the greatest number.
    end: Option<u64>,
    /// Blocks still to read: file and block, the next one last.
    blocks: Vec<(usize, usize)>,
    /// Blocks read and not yet returned, by the log time of their first message, their file and their offset: each has at least
    /// one message, and they are in order of log time. Blocks of one file may overlap in time.
    open: BTreeMap<(u64, usize, usize), std::vec::IntoIter<Message>>,
    held: Held,
}

impl Recording {
    /// The messages selected, in order of log time; messages of equal log time in the order of the file.
    ///
    /// # Errors
    /// If a named topic does not exist.
    pub fn messages(&self, selection: &Selection) -> Result<Messages<'_>, Failure> {
        let topics = match &selection.topics {
            None => None,
            Some(names) => Some(
                names
                    .iter()
                    .map(|n| Ok(self.channel(n)?.topic.clone()))
                    .collect::<Result<BTreeSet<_>, Failure>>()?,
            ),
        };
        Ok(Messages::new(self, topics, selection.start.unwrap_or(0), selection.end))
    }

    /// The last message on `topic`, whatever its log time.
    ///
    /// # Errors
    /// If the topic does not exist.
    pub fn last(&self, topic: &str) -> Result<Option<Message>, Failure> {
        Ok(self.some_before(topic, None, 1)?.pop())
    }

    /// The last `count` messages on `topic` whose log time is below `time` (ns since 1970), or of all, in order of log time.
    ///
    /// # Errors
    /// If the topic does not exist.
    pub fn some_before(&self, topic: &str, time: Option<u64>, count: usize) -> Result<Vec<Message>, Failure> {
        let is_before = |at: u64| time.is_none_or(|time| at < time);
        let topic = &self.channel(topic)?.topic;
        let topics = BTreeSet::from([topic.to_owned()]);
        let mut best: Vec<Message> = Vec::new();
        let mut blocks: Vec<(&OpenFile, &Block)> =
            self.files.iter().flat_map(|f| f.blocks().iter().map(move |b| (f, b))).collect();
        blocks.retain(|(f, b)| is_before(b.start) && holds(f, b, Some(&topics)));
        blocks.sort_by_key(|(_, b)| Reverse(b.end));
        for (file, block) in blocks {
            if best.len() >= count && best.first().is_some_and(|m| m.log_time >= block.end) {
                break;
            }
            let wanted = |channel: u16| file.index.channels.get(&channel).filter(|info| info.topic == *topic);
            let mut earlier = Vec::new();
            decode(self, file, block, &Held::new(self.size()), wanted, |message| {
                if is_before(message.log_time) {
                    earlier.push(message);
                }
            });
            // Messages of equal log time stay in the order of the file: those of an earlier block come first.
            earlier.append(&mut best);
            earlier.sort_by_key(|m| m.log_time);
            best = earlier.split_off(earlier.len().saturating_sub(count));
        }
        Ok(best)
    }
}

impl<'r> Messages<'r> {
    fn new(recording: &'r Recording, topics: Option<BTreeSet<String>>, start: u64, end: Option<u64>) -> Self {
        let mut blocks = Vec::new();
        for (f, file) in recording.files.iter().enumerate() {
            let in_time = |b: &Block| b.end >= start && end.is_none_or(|end| b.start < end);
            let wanted = |b: &Block| in_time(b) && holds(file, b, topics.as_ref());
            blocks.extend(file.blocks().iter().enumerate().filter(|(_, b)| wanted(b)).map(|(n, _)| (f, n)));
        }
        blocks.sort_by_key(|&(f, n)| Reverse((recording.files[f].blocks()[n].start, f, n)));
        Self {
            recording,
            topics,
            start,
            end,
            blocks,
            open: BTreeMap::new(),
            held: Held::new(recording.size()),
        }
    }

    fn read_block(&mut self, f: usize, n: usize) {
        let file = &self.recording.files[f];
        let block = &file.blocks()[n];
        if self.held.is_full() {
            let detail = "too many bytes of chunks that claim the same time are in memory already".to_owned();
            return self.recording.warn(file.warning(block.offset, WarningKind::DamagedChunk, detail));
        }
        let topics = self.topics.as_ref();
        let in_time = |time: u64| time >= self.start && self.end.is_none_or(|end| time < end);
        let wanted = |channel: u16| {
            let info = file.index.channels.get(&channel);
            info.filter(|info| topics.is_none_or(|t| t.contains(&info.topic)))
        };
        let mut messages = Vec::new();
        decode(self.recording, file, block, &self.held, wanted, |message| {
            if in_time(message.log_time) {
                messages.push(message);
            }
        });
        if !messages.is_sorted_by_key(|m| m.log_time) {
            messages.sort_by_key(|m| m.log_time);
        }
        self.reopen(f, block.offset, messages.into_iter());
    }

    /// Puts the rest of a block in its place; an empty one is done.
    fn reopen(&mut self, f: usize, offset: usize, messages: std::vec::IntoIter<Message>) {
        if let Some(first) = messages.as_slice().first() {
            self.open.insert((first.log_time, f, offset), messages);
        }
    }
}

impl Iterator for Messages<'_> {
    type Item = Message;

    fn next(&mut self) -> Option<Message> {
        // A block that starts no later than the earliest read message may hold an earlier one.
        while let Some(&(f, n)) = self.blocks.last() {
            let start = self.recording.files[f].blocks()[n].start;
            if self.open.first_key_value().is_some_and(|((first, ..), _)| *first < start) {
                break;
            }
            self.blocks.pop();
            self.read_block(f, n);
        }
        let ((_, f, offset), mut block) = self.open.pop_first()?;
        let message = block.next();
        self.reopen(f, offset, block);
        message
    }
}

fn holds(file: &OpenFile, block: &Block, topics: Option<&BTreeSet<String>>) -> bool {
    let (Some(topics), Some(channels)) = (topics, &block.channels) else { return true };
    channels.iter().any(|c| file.index.channels.get(c).is_some_and(|c| topics.contains(&c.topic)))
}

/// Passes each message of a block on a wanted channel to `take`, in the order of the block; an unreadable one becomes a
/// warning.
fn decode<'f>(
    recording: &Recording,
    file: &'f OpenFile,
    block: &Block,
    held: &Held,
    wanted: impl Fn(u16) -> Option<&'f Arc<ChannelInfo>>,
    mut take: impl FnMut(Message),
) {
    let damaged = |detail| recording.warn(file.warning(block.offset, WarningKind::DamagedChunk, detail));
    let content = if block.is_chunk {
        let record = Records::at(file.bytes(), block.offset as u64)
            .ok_or_else(|| "it is an incomplete record".to_owned());
        match record.and_then(|r| chunk::content_in(&r, held.spare())) {
            Ok(Cow::Owned(content)) => held.content(content),
            Ok(Cow::Borrowed(part)) => {
                let at = part.as_ptr().addr() - file.bytes().as_ptr().addr();
                file.part(at..at + part.len())
            }
            Err(detail) => return damaged(detail),
        }
    } else {
        file.part(block.offset..block.end_offset)
    };
    let content = Arc::new(content);
    let mut orphans = 0u64;
    // Most messages are on the channel of the one before.
    let mut last = None;
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
        let id = header.channel_id;
        let channel = match last {
            Some((known, channel)) if known == id => channel,
            _ => {
                let channel = wanted(id);
                last = Some((id, channel));
                channel
            }
        };
        match channel {
            Some(channel) => {
                let (channel, mut payload) = (channel.clone(), Payload { chunk: content.clone(), range });
                if recording.compressed {
                    match chunk::message(&payload) {
                        Ok(bytes) => {
                            let range = 0..bytes.len();
                            payload = Payload { chunk: Arc::new(held.content(bytes)), range };
                        }
                        Err(detail) => {
                            damaged(format!("{}: {detail}", channel.topic));
                            continue;
                        }
                    }
                }
                let MessageHeader { sequence, log_time, publish_time, .. } = header;
                take(Message { channel, sequence, log_time, publish_time, payload });
            }
            None if file.index.channels.contains_key(&id) => {}
            None => orphans += 1,
        }
    }
    if orphans > 0 {
        let detail = format!("{} of channels whose declaration was lost", count(orphans, "message"));
        recording.warn(file.warning(block.offset, WarningKind::Orphans, detail));
    }
}
