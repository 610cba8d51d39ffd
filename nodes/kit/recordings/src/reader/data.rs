//! The data section of a file by the frames of its records: contents of chunks are skipped.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use grainlab_console::count;
use mcap::MAGIC;
use mcap::records::{Record, Statistics, op};

use super::block::{Block, add_loose};
use super::declarations::Declarations;
use super::entry::StoredEntries;
use super::records::{RawRecord, Records};

/// Chunks by their offset: the first byte after each, and the first and last log time that is stated, ns since 1970.
pub(super) type Chunks = BTreeMap<usize, (usize, u64, u64)>;

/// What an index states of the data section.
#[derive(Default)]
pub(super) struct Indexed {
    pub(super) chunks: Chunks,
    /// Lists of messages: the first byte of the lists behind a chunk, and the first byte after them.
    lists: BTreeMap<usize, usize>,
    /// Types of the records at these bytes.
    types: BTreeMap<usize, u8>,
}

impl Indexed {
    /// Adds a record at byte `at`; an error is a contradiction to the records that were added before.
    pub(super) fn add(&mut self, at: usize, opcode: u8) -> Result<(), String> {
        match self.types.insert(at, opcode) {
            Some(other) if other == op::CHUNK || other != opcode => {
                Err(format!("two of its entries point at byte {at}"))
            }
            _ => Ok(()),
        }
    }

    pub(super) fn add_lists(&mut self, range: Range<usize>) {
        self.lists.insert(range.start, range.end);
    }

    /// Forgets lists that reach into the next chunk, and beyond byte `end`, because their length is wrong.
    pub(super) fn bound_lists(&mut self, end: usize) {
        let chunks = &self.chunks;
        self.lists.retain(|from, to| *from < *to && *to <= end && chunks.range(*from..*to).next().is_none());
    }

    pub(super) fn add_header(&mut self) {
        self.types.insert(MAGIC.len(), op::HEADER);
    }

    fn stated(&self, at: usize) -> Option<u8> {
        let is_list = || self.lists.range(..=at).next_back().is_some_and(|(_, end)| at < *end);
        self.types.get(&at).copied().or_else(|| is_list().then_some(op::MESSAGE_INDEX))
    }

    /// Forgets the types of the records, so that the data section alone tells them.
    pub(super) fn forget_types(&mut self) {
        self.lists.clear();
        self.types.clear();
    }
}

/// Damaged records with the same fault and the same type. All records between the first and the last have this type, too: a hole of
/// zeros in a file is one record after every nine bytes.
pub(super) struct DamagedRun {
    /// Byte of the first record.
    pub(super) at: usize,
    /// First byte after the last record of this type.
    end: usize,
    opcode: u8,
    records: u64,
    fault: String,
}

impl DamagedRun {
    pub(super) fn detail(self) -> String {
        match self.records - 1 {
            0 => self.fault,
            n => format!(
                "{}; so {} up to byte {}",
                self.fault,
                if n == 1 { "is 1 more record".to_owned() } else { format!("are {n} more records") },
                self.end
            ),
        }
    }
}

#[derive(Default)]
pub(super) struct Data {
    pub(super) chunks: Chunks,
    /// Channels with messages in the lists behind each chunk, by the offset of the chunk.
    listed_channels: BTreeMap<usize, BTreeSet<u16>>,
    /// Messages outside chunks.
    pub(super) loose: Vec<Block>,
    pub(super) stored: StoredEntries,
    /// Faults of declarations and metadata records: the byte of each, and what is wrong.
    pub(super) faults: Vec<(usize, String)>,
    /// Damaged records, other than the chunks that the index knows.
    pub(super) damaged: Vec<DamagedRun>,
    /// Messages by channel: those listed behind the chunks, and those outside chunks.
    pub(super) counts: BTreeMap<u16, u64>,
    /// True if messages are listed behind chunks.
    pub(super) listed: bool,
    pub(super) wrong: Option<String>,
    /// Byte of the first record after the end record.
    pub(super) after_end: Option<usize>,
    /// Byte at which no complete record starts, before the end record.
    pub(super) broken: Option<usize>,
}

impl Data {
    /// Reads the records of `bytes`, which end with the data section; adds the schemas and channels outside chunks to `declared`.
    pub(super) fn of(bytes: &[u8], declared: &mut Declarations, indexed: &Indexed) -> Self {
        let (mut data, mut ended) = (Self::default(), false);
        const ANY: (usize, u64, u64) = (0, 0, u64::MAX);
        let mut chunk = ANY;
        for record in Records::new(bytes, MAGIC.len()) {
            let record = match record {
                Ok(record) => record,
                Err(at) => return Self { broken: Some(at), ..data },
            };
            let at = record.offset;
            if ended {
                data.after_end.get_or_insert(at);
            }
            if record.opcode != op::MESSAGE_INDEX {
                // A damaged chunk states no times.
                chunk = ANY;
            }
            if let Some(run) =
                data.damaged.last_mut().filter(|run| run.end == at && run.opcode == record.opcode)
            {
                run.end = record.end();
            }
            match indexed.stated(at).filter(|stated| *stated != record.opcode) {
                // It is found when the chunk is read.
                Some(op::CHUNK) => {
                    chunk = ANY;
                    continue;
                }
                Some(stated) => {
                    let fault = format!("its type is 0x{:02x}, by the index 0x{stated:02x}", record.opcode);
                    data.add_damaged(&record, fault);
                    continue;
                }
                None => {}
            }
            match record.opcode {
                op::HEADER if at == MAGIC.len() => {}
                op::DATA_END => ended = true,
                op::CHUNK => match record.parse() {
                    Ok(Record::Chunk { header, .. }) => {
                        chunk = (at, header.message_start_time, header.message_end_time);
                        data.chunks.insert(at, (record.end(), chunk.1, chunk.2));
                    }
                    Err(fault) if !indexed.chunks.contains_key(&at) => data.add_damaged(&record, fault),
                    _ => {}
                },
                op::MESSAGE_INDEX => match record.fit() {
                    Ok(()) => data.list(record.body, at, chunk),
                    Err(fault) => {
                        chunk = ANY;
                        data.add_damaged(&record, fault);
                    }
                },
                op::MESSAGE => match record.message() {
                    Some((header, _)) => {
                        *data.counts.entry(header.channel_id).or_default() += 1;
                        add_loose(&mut data.loose, &record, &header);
                    }
                    None => data.add_damaged(&record, "its header is incomplete".to_owned()),
                },
                op::SCHEMA | op::CHANNEL => {
                    let added = record.parse().and_then(|parsed| declared.add(parsed));
                    data.faults
                        .extend(added.err().or_else(|| record.repeated_key()).map(|fault| (at, fault)));
                }
                _ => {
                    data.faults.extend(record.repeated_key().map(|fault| (at, fault)));
                    data.stored.add(&record);
                }
            }
        }
        data.broken = (!ended).then_some(bytes.len());
        data
    }

    /// Adds a damaged record to the last run if it continues the run.
    fn add_damaged(&mut self, record: &RawRecord<'_>, fault: String) {
        let (at, end, opcode) = (record.offset, record.end(), record.opcode);
        match self
            .damaged
            .last_mut()
            .filter(|run| run.end == end && run.opcode == opcode && run.fault == fault)
        {
            Some(run) => run.records += 1,
            None => self.damaged.push(DamagedRun { at, end, opcode, records: 1, fault }),
        }
    }

    pub(super) fn contradiction(&self, indexed: &Chunks, counted: &Statistics) -> Option<String> {
        // A damaged record may have stated messages.
        let differs = |stated: u64, found: u64| stated < found || stated > found && self.damaged.is_empty();
        // An entry without a chunk is a damaged chunk, which is found when it is read.
        let unlike = self.chunks.iter().find(|(at, stated)| indexed.get(at) != Some(*stated));
        if let Some((at, _)) = unlike {
            let number = format!("{} chunks in it, {} in the file", indexed.len(), self.chunks.len());
            return Some(match indexed.contains_key(at) {
                true => format!("the chunk at byte {at} has another length or other times than in it"),
                false => format!("it lacks the chunk at byte {at}: {number}"),
            });
        }
        let (stated, of_topics) = (counted.message_count, &counted.channel_message_counts);
        let sum = |counts: &BTreeMap<u16, u64>| counts.values().sum::<u64>();
        let by_records = (self.listed || self.chunks.is_empty()).then_some(&self.counts);
        if let Some(found) = by_records.map(sum).filter(|found| differs(stated, *found)) {
            return Some(format!("{} by its statistics, {found} by the records", count(stated, "message")));
        }
        if !of_topics.is_empty() && sum(of_topics) != stated {
            let of_topics = sum(of_topics);
            return Some(format!(
                "{} by its statistics, {of_topics} by its counts of each channel",
                count(stated, "message")
            ));
        }
        let mut found = by_records.into_iter().flatten();
        let unlike = found.find_map(|(channel, found)| {
            let stated = of_topics.get(channel).filter(|stated| differs(**stated, *found))?;
            let stated = count(*stated, "message");
            Some(format!("{stated} on channel {channel} by its statistics, {found} by the records"))
        });
        unlike.or_else(|| self.wrong.clone())
    }

    /// Returns the first block whose entry in the index lacks a channel that is listed behind its chunk.
    pub(super) fn unlisted_channel(&self, blocks: &[Block]) -> Option<String> {
        blocks.iter().find_map(|block| {
            let (stated, listed) = (block.channels.as_ref()?, self.listed_channels.get(&block.offset)?);
            let channel = listed.difference(stated).next()?;
            Some(format!("its entry of the chunk at byte {} lacks channel {channel}", block.offset))
        })
    }

    /// Counts the entries of a message index, 16 bytes with log time first; compares the first and the last with their chunk.
    fn list(&mut self, body: &[u8], offset: usize, (chunk, start, end): (usize, u64, u64)) {
        let Some((channel, entries)) = body.split_first_chunk::<2>() else { return };
        let entries = entries.get(4..).unwrap_or_default().as_chunks::<16>().0;
        self.listed = true;
        let channel = u16::from_le_bytes(*channel);
        *self.counts.entry(channel).or_default() += entries.len() as u64;
        if !entries.is_empty() {
            self.listed_channels.entry(chunk).or_default().insert(channel);
        }
        let time = |entry: &[u8; 16]| u64::from_le_bytes(std::array::from_fn(|n| entry[n]));
        if [entries.first(), entries.last()].into_iter().flatten().any(|e| !(start..=end).contains(&time(e)))
        {
            let detail = "a message is not within the times of its chunk";
            self.wrong.get_or_insert_with(|| format!("{detail}, by the list at byte {offset}"));
        }
    }
}
