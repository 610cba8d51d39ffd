//! The data section of a file by the frames of its records: contents of chunks are skipped.

use std::collections::BTreeMap;

use mcap::MAGIC;
use mcap::records::{Record, Statistics, op};

use super::block::{Block, add_loose};
use super::records::Records;

/// Chunks by their offset: the first byte after each, and the first and last log time that is stated, ns since 1970.
pub(super) type Chunks = BTreeMap<usize, (usize, u64, u64)>;

/// Content of the data section.
#[derive(Default)]
pub(super) struct Data {
    pub(super) chunks: Chunks,
    /// Messages outside chunks.
    pub(super) loose: Vec<Block>,
    /// Messages by channel: those listed behind the chunks, and those outside chunks.
    pub(super) counts: BTreeMap<u16, u64>,
    /// True if messages are listed behind chunks.
    pub(super) listed: bool,
    /// A contradiction in it.
    pub(super) wrong: Option<String>,
    /// Byte at which no complete record starts, before the end record.
    pub(super) broken: Option<usize>,
}

impl Data {
    /// The records of `bytes`, which end with the data section.
    pub(super) fn of(bytes: &[u8]) -> Self {
        let (mut data, mut ended) = (Self::default(), false);
        const ANY: (u64, u64) = (0, u64::MAX);
        let mut chunk = ANY;
        for record in Records::new(bytes, MAGIC.len()) {
            let record = match record {
                Ok(record) => record,
                Err(at) => return Self { broken: Some(at), ..data },
            };
            ended = record.opcode == op::DATA_END;
            if record.opcode != op::MESSAGE_INDEX {
                // A damaged chunk states no times.
                chunk = ANY;
            }
            match record.opcode {
                op::CHUNK => {
                    if let Ok(Record::Chunk { header, .. }) = record.parse() {
                        chunk = (header.message_start_time, header.message_end_time);
                        data.chunks.insert(record.offset, (record.end(), chunk.0, chunk.1));
                    }
                }
                op::MESSAGE_INDEX => data.list(record.body, record.offset, chunk),
                _ => {
                    if let Some((header, _)) = record.message() {
                        *data.counts.entry(header.channel_id).or_default() += 1;
                        add_loose(&mut data.loose, &record, &header);
                    }
                }
            }
        }
        data.broken = (!ended).then_some(bytes.len());
        data
    }

    /// The first contradiction between the data section, the chunks of an index, and its counts.
    pub(super) fn contradiction(&self, indexed: &Chunks, counted: &Statistics) -> Option<String> {
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
        let differs = |counts: &BTreeMap<u16, u64>| {
            counts.iter().any(|(channel, n)| of_topics.get(channel).is_some_and(|stated| stated != n))
                || sum(counts) != stated
        };
        let is_counted = self.listed || self.chunks.is_empty();
        let counts = [(is_counted, &self.counts), (!of_topics.is_empty(), of_topics)];
        let wrong = counts.into_iter().find(|(given, counts)| *given && differs(counts));
        let text =
            |counts| format!("{stated} messages by its statistics, {} by the records or topics", sum(counts));
        wrong.map(|(_, counts)| text(counts)).or_else(|| self.wrong.clone())
    }

    /// Counts the entries of a message index: 16 bytes each, log time first. The first and the last are compared with the times
    /// of their chunk.
    fn list(&mut self, body: &[u8], offset: usize, chunk: (u64, u64)) {
        let Some((channel, entries)) = body.split_first_chunk::<2>() else { return };
        let entries = entries.get(4..).unwrap_or_default().as_chunks::<16>().0;
        self.listed = true;
        *self.counts.entry(u16::from_le_bytes(*channel)).or_default() += entries.len() as u64;
        let time = |entry: &[u8; 16]| u64::from_le_bytes(std::array::from_fn(|n| entry[n]));
        if [entries.first(), entries.last()]
            .into_iter()
            .flatten()
            .any(|e| !(chunk.0..=chunk.1).contains(&time(e)))
        {
            let detail = "a message is not within the times of its chunk";
            self.wrong.get_or_insert_with(|| format!("{detail}, by the list at byte {offset}"));
        }
    }
}
