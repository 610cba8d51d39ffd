//! Messages in order of log time.

use super::block::Block;
use super::channel::ChannelInfo;
use super::chunk;
use super::error::{Warning, WarningKind};
use super::file::OpenFile;
use super::held::Held;
use super::message::{Message, Payload};
use super::recording::Recording;
use super::records::{Records, is_misplaced, is_unknown, misplaced};
use grainlab_console::{Failure, count};
use mcap::records::{MessageHeader, op};
use std::borrow::Cow;
use std::cell::RefCell;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Selects messages by topic and log time.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Names of topics, with or without the leading slash; `None` for all.
    pub topics: Option<Vec<String>>,
    /// First log time, ns since 1970.
    pub start: Option<u64>,
    /// Log time before which to end, ns since 1970.
    pub end: Option<u64>,
}

impl Selection {
    /// All messages on these topics.
    pub fn topics<S: Into<String>>(names: impl IntoIterator<Item = S>) -> Self {
        Self { topics: Some(names.into_iter().map(Into::into).collect()), ..Self::default() }
    }
}

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
    damage: Option<Warning>,
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
        let counts = BTreeMap::from([(self.channel(topic)?.topic.clone(), 1)]);
        Ok(self.each_before(&counts, None).into_values().flatten().next())
    }

    /// Returns for each topic its last messages whose log time is below `time` (ns since 1970), or of all, as many as `counts` states, in
    /// order of log time. No block is read twice.
    pub(crate) fn each_before(
        &self,
        counts: &BTreeMap<String, usize>,
        time: Option<u64>,
    ) -> BTreeMap<String, Vec<Message>> {
        let is_before = |log_time: u64| time.is_none_or(|time| log_time < time);
        let mut best: BTreeMap<String, Vec<Message>> =
            counts.keys().map(|t| (t.clone(), Vec::new())).collect();
        let mut blocks: Vec<(&OpenFile, &Block)> =
            self.files.iter().flat_map(|f| f.blocks().iter().map(move |b| (f, b))).collect();
        blocks.retain(|(_, b)| is_before(b.start));
        blocks.sort_by_key(|(_, b)| Reverse(b.end));
        for (file, block) in blocks {
            let is_wanted = |topic: &str| {
                let needed = |n: &usize| {
                    let has: &[Message] = best.get(topic).map(Vec::as_slice).unwrap_or_default();
                    has.len() < *n || has.first().is_none_or(|m| m.log_time < block.end)
                };
                counts.get(topic).is_some_and(needed)
            };
            let topic_of = |id: &u16| file.index.channels.get(id).map(|c| c.topic.as_str());
            let is_read = match &block.channels {
                Some(channels) => channels.iter().filter_map(topic_of).any(is_wanted),
                None => counts.keys().any(|topic| is_wanted(topic)),
            };
            if !is_read {
                continue;
            }
            let wanted = |id: u16| file.index.channels.get(&id).filter(|info| is_wanted(&info.topic));
            let mut earlier = BTreeMap::<String, Vec<Message>>::new();
            let mut take = |message: Message| {
                if is_before(message.log_time) {
                    earlier.entry(message.channel.topic.clone()).or_default().push(message);
                }
            };
            decode(self, file, block, &Held::new(self.size()), wanted, &mut take, &mut |w| self.warn(w));
            for (topic, mut found) in earlier {
                let best = best.entry(topic.clone()).or_default();
                // Messages of equal log time stay in the order of the file: messages of an earlier block come first.
                found.append(best);
                found.sort_by_key(|m| m.log_time);
                *best = found.split_off(found.len().saturating_sub(counts[&topic]));
            }
        }
        best
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
            damage: None,
        }
    }

    /// Returns the first damage met so far, by which messages of this selection may be missing.
    pub fn damage(&self) -> Option<&Warning> {
        self.damage.as_ref()
    }

    fn read_block(&mut self, f: usize, n: usize) {
        let file = &self.recording.files[f];
        let block = &file.blocks()[n];
        if self.held.is_full() {
            let detail = "too many bytes of chunks that claim the same time are in memory already".to_owned();
            let full = file.warning(block.offset, WarningKind::DamagedChunk, detail);
            self.damage.get_or_insert_with(|| full.clone());
            return self.recording.warn(full);
        }
        let topics = self.topics.as_ref();
        let in_time = |time: u64| time >= self.start && self.end.is_none_or(|end| time < end);
        let wanted = |channel: u16| {
            let info = file.index.channels.get(&channel);
            info.filter(|info| topics.is_none_or(|t| t.contains(&info.topic)))
        };
        let mut messages = Vec::new();
        let mut take = |message: Message| {
            if in_time(message.log_time) {
                messages.push(message);
            }
        };
        let (recording, damage) = (self.recording, &mut self.damage);
        let mut warn = |warning: Warning| {
            // A contradiction leaves no message out.
            if warning.kind != WarningKind::Inconsistent {
                damage.get_or_insert_with(|| warning.clone());
            }
            recording.warn(warning);
        };
        decode(recording, file, block, &self.held, wanted, &mut take, &mut warn);
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

/// Passes each message of a block on a wanted channel to `take`, in the order of the block, and unreadable parts to `warn`.
fn decode<'f>(
    recording: &Recording,
    file: &'f OpenFile,
    block: &Block,
    held: &Held,
    wanted: impl Fn(u16) -> Option<&'f Arc<ChannelInfo>>,
    take: &mut impl FnMut(Message),
    warn: &mut impl FnMut(Warning),
) {
    let warn = RefCell::new(warn);
    let damaged = |detail| warn.borrow_mut()(file.warning(block.offset, WarningKind::DamagedChunk, detail));
    let contradicts =
        |detail| warn.borrow_mut()(file.warning(block.offset, WarningKind::Inconsistent, detail));
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
    let (mut last, mut is_in_time) = (None, true);
    for record in Records::new(content.bytes(), 0) {
        let record = match record {
            Ok(record) if record.opcode == op::MESSAGE => record,
            Ok(record) => {
                match record.opcode {
                    op::SCHEMA | op::CHANNEL => {
                        let parsed = record.parse().ok();
                        let difference = parsed.and_then(|parsed| file.index.declared.difference(&parsed));
                        difference.or_else(|| record.repeated_key()).into_iter().for_each(contradicts);
                    }
                    opcode if is_misplaced(opcode) => contradicts(misplaced(opcode)),
                    opcode if is_unknown(opcode) => recording.found_unknown(opcode),
                    _ => {}
                }
                continue;
            }
            Err(at) => return damaged(format!("an incomplete record starts at byte {at} of its content")),
        };
        let Some((header, range)) = record.message() else {
            damaged(format!("the message at byte {} of its content has an incomplete header", record.offset));
            continue;
        };
        if is_in_time && !(block.start..=block.end).contains(&header.log_time) {
            // One line for a chunk is enough.
            is_in_time = false;
            let (time, start, end) = (header.log_time, block.start, block.end);
            contradicts(format!(
                "a message of {time} ns is not within the times that the index states for its chunk, {start} to {end} ns"
            ));
        }
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
        warn.borrow_mut()(file.warning(block.offset, WarningKind::Orphans, detail));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of `chunks` chunks at the same time, each with one message of `bytes` zeros.
    fn bomb(chunks: u32, bytes: usize) -> tempfile::NamedTempFile {
        let file = tempfile::NamedTempFile::new().unwrap();
        let options = mcap::WriteOptions::new().compression_threads(0).chunk_size(None);
        let mut writer = options.create(file.reopen().unwrap()).unwrap();
        let channel_id = writer.add_channel(0, "/t", "cdr", &BTreeMap::new()).unwrap();
        for sequence in 0..chunks {
            for (log_time, length) in [(1, bytes), (2, 4)] {
                let header = MessageHeader { channel_id, sequence, log_time, publish_time: 1 };
                writer.write_to_known_channel(&header, &vec![0; length]).unwrap();
            }
            writer.flush().unwrap();
        }
        writer.finish().unwrap();
        file
    }

    #[test]
    fn chunks_that_claim_the_same_time_are_not_all_in_memory_together() {
        let file = bomb(20, 600 << 10);
        let recording = Recording::open(file.path()).unwrap();
        let mut messages = recording.messages(&Selection::default()).unwrap();
        // A limit of 2.5 MB instead of a gigabyte.
        messages.held = Held::up_to(2500 << 10);
        let large: usize = messages.collect::<Vec<_>>().iter().map(|m| m.payload.len()).sum();
        assert!(large <= 3200 << 10, "{large}");
        let warnings = recording.warnings();
        assert!(warnings.iter().all(|w| w.kind == WarningKind::DamagedChunk));
        assert!(warnings.len() >= 14, "{}", warnings.len());
    }
}
