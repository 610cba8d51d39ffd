//! Positions of the parts of a file: from its summary, or by reading all of it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use grainlab_console::count;
use mcap::MAGIC;
use mcap::records::{ChunkIndex, Record, op};

use super::block::{Block, add_loose};
use super::channel::ChannelInfo;
use super::chunk;
use super::data::{Data, Indexed};
use super::declarations::Declarations;
use super::end;
use super::entry::{Entry, StoredEntries};
use super::error::{Warning, WarningKind};
use super::records::{FRAME, RawRecord, Records, is_misplaced, is_unknown, misplaced};
use super::walk::{Walked, place, walk};

/// Bytes of the body of an end record of the data.
const DATA_END: usize = 4;

const AFTER_END: &str = "records follow the end record of the data, which MCAP forbids; they are read";

#[derive(Clone, Debug, Default)]
pub(super) struct Index {
    pub(super) profile: String,
    pub(super) library: String,
    pub(super) channels: BTreeMap<u16, Arc<ChannelInfo>>,
    /// In order of start, then of offset.
    pub(super) blocks: Vec<Block>,
    pub(super) stored: StoredEntries,
    /// Messages by channel.
    pub(super) counts: BTreeMap<u16, u64>,
    pub(super) compressions: BTreeSet<String>,
    pub(super) complete: bool,
    /// True if the file is complete and its index is absent or lacks a part, which the format allows.
    pub(super) absent: bool,
    pub(super) declared: Declarations,
    /// Bytes of the recording; others may follow in the file.
    pub(super) length: usize,
}

impl Index {
    /// The index of a file that starts with the MCAP magic.
    pub(super) fn build(path: &Path, bytes: &[u8], warnings: &mut BTreeSet<Warning>) -> Self {
        let (mut own, mut found) = (bytes, Self::from_summary(path, bytes, warnings));
        // Nothing follows the end of a file whose summary is right.
        if !matches!(found, Ok(Some(_)))
            && let Some(at) = end::length_of_first(bytes)
        {
            let (offset, kind, detail) = (at as u64, WarningKind::AfterEnd, end::following(bytes, at));
            warnings.insert(Warning { path: path.to_owned(), offset, kind, detail });
            own = &bytes[..at];
            found = Self::from_summary(path, own, warnings);
        }
        let mut index = match found {
            Ok(Some(index)) => index,
            Ok(None) => Self { absent: true, ..Self::from_scan(path, own, None, warnings) },
            Err(reason) => Self::from_scan(path, own, Some(&reason), warnings),
        };
        if let Some(Ok(Record::Header(header))) = Records::at(bytes, MAGIC.len() as u64).map(|r| r.parse()) {
            (index.profile, index.library) = (header.profile, header.library);
        }
        index.length = own.len();
        index.blocks.sort_by_key(|b| (b.start, b.offset));
        index
    }

    /// The index in the file, `None` without one: all parts of a summary are optional. Contradictions to the records are errors.
    fn from_summary(
        path: &Path,
        bytes: &[u8],
        warnings: &mut BTreeSet<Warning>,
    ) -> Result<Option<Self>, String> {
        let (footer, footer_at) = end::footer(bytes)?;
        let start = usize::try_from(footer.summary_start).unwrap_or(usize::MAX);
        if footer.summary_start == 0 {
            return Ok(None);
        }
        if start >= footer_at {
            return Err(format!("the summary section begins at byte {start}, behind its end"));
        }
        let crc = crc32fast::hash(&bytes[start..footer_at + FRAME + 16]);
        if footer.summary_crc != 0 && crc != footer.summary_crc {
            return Err("the checksum of the summary section fails".into());
        }
        let mut index = Self { complete: true, ..Self::default() };
        let (mut counted, mut indexed, mut listed) = (None, Indexed::default(), StoredEntries::default());
        let mut faults = Vec::new();
        for record in Records::new(&bytes[..footer_at], start) {
            let record = record.map_err(|at| format!("the summary section breaks off at byte {at}"))?;
            match record.parse()? {
                Record::Statistics(s) => counted = Some(s),
                Record::ChunkIndex(c) => index.chunk(bytes, start, c, &mut indexed)?,
                Record::AttachmentIndex(a) => {
                    indexed.add(usize::try_from(a.offset).unwrap_or(usize::MAX), op::ATTACHMENT)?;
                    listed.attachments.push(Entry { offset: a.offset, name: a.name });
                }
                Record::MetadataIndex(m) => {
                    indexed.add(usize::try_from(m.offset).unwrap_or(usize::MAX), op::METADATA)?;
                    listed.metadata.push(Entry { offset: m.offset, name: m.name });
                }
                declaration @ (Record::Schema { .. } | Record::Channel(_)) => {
                    let fault = record.repeated_key();
                    faults.extend(fault.map(|fault| (record.offset, WarningKind::Inconsistent, fault)));
                    index.declared.add(declaration)?;
                }
                Record::SummaryOffset(_) => {}
                Record::Unknown { opcode, .. } => _ = listed.unknown.insert(opcode),
                other => {
                    return Err(format!(
                        "a record of type 0x{:02x} is in the summary section",
                        other.opcode()
                    ));
                }
            }
        }
        let Some(counted) = counted else { return Ok(None) };
        indexed.bound_lists(start.saturating_sub(FRAME + DATA_END));
        if footer.summary_crc == 0 {
            // Without a checksum the index may be what is damaged.
            indexed.forget_types();
        } else {
            indexed.add_header();
        }
        let data = Data::of(&bytes[..start], &mut index.declared, &indexed);
        let (channels, without_schema) = index.declared.channels();
        if !without_schema.is_empty()
            || (channels.len() as u64) < u64::from(counted.channel_count)
            || index.declared.schemas() < usize::from(counted.schema_count)
        {
            return Ok(None);
        }
        index.channels = channels;
        if let Some(at) = data.broken {
            // The records behind it can only be reached by the index.
            let detail = match at == start {
                true => "the end record of the data is missing",
                false => "no complete record starts here; later ones can be reached by the index only",
            };
            faults.push((at, WarningKind::Inconsistent, detail.to_owned()));
        } else if indexed.chunks.is_empty() && !data.chunks.is_empty() {
            return Ok(None);
        } else if let Some(wrong) = data
            .contradiction(&indexed.chunks, &counted)
            .or_else(|| data.unlisted_channel(&index.blocks))
            .or_else(|| data.stored.contradiction(&listed, &counted, !data.damaged.is_empty()))
        {
            return Err(wrong);
        }
        let unknown = std::mem::take(&mut index.stored.unknown);
        let (own, other) = if data.broken.is_some() { (listed, data.stored) } else { (data.stored, listed) };
        index.stored = own;
        index.stored.unknown.extend(unknown.into_iter().chain(other.unknown));
        faults.extend(data.faults.into_iter().map(|(at, fault)| (at, WarningKind::Inconsistent, fault)));
        faults.extend(data.damaged.into_iter().map(|run| (run.at, WarningKind::DamagedRecord, run.detail())));
        faults.extend(data.after_end.map(|at| (at, WarningKind::Inconsistent, AFTER_END.to_owned())));
        warnings.extend(faults.into_iter().map(|(at, kind, detail)| Warning {
            path: path.to_owned(),
            offset: at as u64,
            kind,
            detail,
        }));
        index.blocks.extend(data.loose);
        index.counts = counted.channel_message_counts;
        if index.counts.is_empty() {
            index.counts = data.counts;
        }
        let is_complete = index.counts.keys().all(|c| index.channels.contains_key(c))
            && index.counts.values().sum::<u64>() == counted.message_count;
        Ok(is_complete.then_some(index))
    }

    fn chunk(
        &mut self,
        bytes: &[u8],
        summary: usize,
        entry: ChunkIndex,
        indexed: &mut Indexed,
    ) -> Result<(), String> {
        let (start, end) = (entry.message_start_time, entry.message_end_time);
        let offset = usize::try_from(entry.chunk_start_offset).unwrap_or(usize::MAX);
        let end_offset = offset.saturating_add(usize::try_from(entry.chunk_length).unwrap_or(usize::MAX));
        if end_offset > summary {
            return Err(format!("the chunk index points at byte {offset}, outside the data"));
        }
        indexed.add(offset, op::CHUNK)?;
        indexed.chunks.insert(offset, (end_offset, start, end));
        let lists = usize::try_from(entry.message_index_length).unwrap_or(usize::MAX);
        indexed.add_lists(end_offset..end_offset.saturating_add(lists));
        self.compressions.insert(entry.compression);
        // A chunk without messages (schemas and channels) has no times, and a message may have the time 0.
        let channels: BTreeSet<u16> = entry.message_index_offsets.into_keys().collect();
        if end > 0 || self.has_messages(bytes, offset).unwrap_or(!channels.is_empty()) {
            // An empty list states that the messages are not indexed.
            let channels = (!channels.is_empty()).then_some(channels);
            self.blocks.push(Block { offset, end_offset, start, end, channels, is_chunk: true });
        }
        Ok(())
    }

    /// Returns true if the chunk at this byte has a message, or `None` if it cannot be read. Takes all else that is in it.
    fn has_messages(&mut self, bytes: &[u8], offset: usize) -> Option<bool> {
        let content = chunk::content(&Records::at(bytes, offset as u64)?).ok()?;
        let mut has_messages = false;
        for record in Records::new(&content, 0).flatten() {
            match record.opcode {
                op::MESSAGE => has_messages = true,
                // A contradiction is found when the chunk is read.
                op::SCHEMA | op::CHANNEL => _ = record.parse().and_then(|parsed| self.declared.add(parsed)),
                opcode => self.stored.unknown.extend(is_unknown(opcode).then_some(opcode)),
            }
        }
        Some(has_messages)
    }

    fn from_scan(path: &Path, bytes: &[u8], reason: Option<&str>, warnings: &mut BTreeSet<Warning>) -> Self {
        let mut index = Self::default();
        let mut first_named = BTreeMap::new();
        // The first byte after the data, and whether more data was found there.
        let (mut summary, mut goes_on) = (bytes.len(), false);
        let mut warn = |(offset, kind): (usize, WarningKind), detail: String| {
            warnings.insert(Warning { path: path.to_owned(), offset: offset as u64, kind, detail });
        };
        let end = walk(bytes, &mut |item| {
            match item {
                Walked::Record(record, None) if record.opcode == op::DATA_END && !index.complete => {
                    (index.complete, summary) = (true, record.end());
                    if let Some(reason) = reason {
                        warn((record.offset, WarningKind::NoIndex), reason.to_owned());
                    }
                }
                Walked::Record(record, chunk) => {
                    let at = chunk.unwrap_or(record.offset);
                    if index.complete && !goes_on && !is_unknown(record.opcode) {
                        goes_on = true;
                        warn((at, WarningKind::Inconsistent), AFTER_END.to_owned());
                    }
                    let misplaced = chunk.is_some() && is_misplaced(record.opcode);
                    if record.opcode == op::CHUNK && !misplaced {
                        index.blocks.push(Block::empty(&record, true));
                    }
                    match record.fit().and_then(|()| match record.opcode {
                        op::CHUNK | op::MESSAGE_INDEX => Ok(None),
                        _ => record.parse().map(Some),
                    }) {
                        _ if misplaced => {
                            warn((at, WarningKind::Inconsistent), self::misplaced(record.opcode));
                        }
                        // The content of a chunk is walked through.
                        Ok(None) => {}
                        Err(_) if record.opcode == op::CHUNK => {}
                        Err(detail) => warn(place(&record, chunk), detail),
                        Ok(Some(parsed)) => {
                            if let Some(fault) = record.repeated_key() {
                                warn((at, WarningKind::Inconsistent), fault);
                            }
                            if let Record::Channel(channel) = &parsed {
                                first_named.entry(channel.id).or_insert(at);
                            }
                            if let Err(detail) = index.add(&record, parsed, chunk.is_some()) {
                                warn((at, WarningKind::Inconsistent), detail);
                            }
                        }
                    }
                }
                Walked::ChunkEnd(chunk) => {
                    if let Ok(Record::Chunk { header, .. }) = chunk.parse() {
                        index.compressions.insert(header.compression);
                    }
                }
                Walked::Unreadable(at, kind, detail) => warn((at, kind), detail),
            }
            true
        });
        index.blocks.retain(|block| block.start <= block.end);
        if index.complete {
            // A declaration that was lost with a chunk may be repeated in the summary.
            let mut misplaced = None;
            for record in Records::new(bytes, summary).map_while(Result::ok) {
                let is_data =
                    matches!(record.opcode, op::MESSAGE | op::CHUNK | op::ATTACHMENT | op::METADATA);
                if is_data && record.offset >= end {
                    misplaced.get_or_insert((record.offset, 0)).1 += 1;
                }
                if let (op::SCHEMA | op::CHANNEL, Ok(parsed)) = (record.opcode, record.parse()) {
                    if let Some(fault) = record.repeated_key() {
                        warn((record.offset, WarningKind::Inconsistent), fault);
                    }
                    _ = index.declared.add(parsed);
                }
            }
            if let Some((at, number)) = misplaced {
                let records = count(number, "record");
                let detail = format!(
                    "{records} of the data in or after the summary, where MCAP allows none: not read"
                );
                warn((at, WarningKind::AfterEnd), detail);
            }
        }
        let (channels, without_schema) = index.declared.channels();
        for (id, detail) in without_schema {
            let at = first_named.get(&id).copied().unwrap_or(end);
            warn((at, WarningKind::Inconsistent), format!("{detail}: its messages are left out"));
        }
        index.counts.retain(|id, _| channels.contains_key(id));
        index.channels = channels;
        if !index.complete {
            let detail = match bytes.len().saturating_sub(end) {
                0 => "its end record is missing".to_owned(),
                left => format!("its last {left} bytes are an incomplete record"),
            };
            warn((end, WarningKind::Truncated), detail);
        }
        index
    }

    /// Adds a record outside chunks, or inside the last one.
    fn add(&mut self, raw: &RawRecord<'_>, record: Record<'_>, in_chunk: bool) -> Result<(), String> {
        match record {
            Record::Message { header, .. } => {
                *self.counts.entry(header.channel_id).or_default() += 1;
                match self.blocks.last_mut().filter(|_| in_chunk) {
                    Some(chunk) => chunk.include(&header),
                    None => add_loose(&mut self.blocks, raw, &header),
                }
            }
            Record::Schema { .. } | Record::Channel(_) => self.declared.add(record)?,
            _ if !in_chunk || is_unknown(raw.opcode) => self.stored.add(raw),
            _ => {}
        }
        Ok(())
    }
}
