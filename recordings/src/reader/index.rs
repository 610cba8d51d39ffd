//! Positions of the parts of a file: from its summary, or by reading all of it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use mcap::MAGIC;
use mcap::records::{Channel, Footer, MessageHeader, Record, SchemaHeader, op};

use super::block::{Block, add_loose};
use super::channel::ChannelInfo;
use super::data::{Chunks, Data};
use super::definition::StoredDefinition;
use super::error::{Warning, WarningKind};
use super::records::{FRAME, RawRecord, Records};
use super::walk::{Walked, place, walk};

/// Position of a metadata record or an attachment.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) offset: u64,
    pub(super) name: String,
}

#[derive(Clone, Debug, Default)]
pub(super) struct Index {
    pub(super) profile: String,
    pub(super) library: String,
    pub(super) channels: BTreeMap<u16, Arc<ChannelInfo>>,
    /// In order of start, then of offset.
    pub(super) blocks: Vec<Block>,
    pub(super) attachments: Vec<Entry>,
    pub(super) metadata: Vec<Entry>,
    /// Messages by channel.
    pub(super) counts: BTreeMap<u16, u64>,
    pub(super) compressions: BTreeSet<String>,
    /// True if the file is complete.
    pub(super) complete: bool,
    /// True if the file is complete and has no index, which the format allows.
    pub(super) absent: bool,
    schemas: BTreeMap<u16, (SchemaHeader, Vec<u8>)>,
}

/// The messages of a chunk that is being read.
#[derive(Default)]
struct Inside {
    /// First and last log time, ns since 1970.
    bounds: Option<(u64, u64)>,
    channels: BTreeSet<u16>,
}

impl Inside {
    fn add(&mut self, header: &MessageHeader) {
        let time = header.log_time;
        self.bounds = Some(self.bounds.map_or((time, time), |(a, b)| (a.min(time), b.max(time))));
        self.channels.insert(header.channel_id);
    }
}

impl Index {
    /// The index of a file that starts with the MCAP magic.
    pub(super) fn build(path: &Path, bytes: &[u8], warnings: &mut BTreeSet<Warning>) -> Self {
        let mut index = match Self::from_summary(path, bytes, warnings) {
            Ok(Some(index)) => index,
            Ok(None) => Self { absent: true, ..Self::from_scan(path, bytes, None, warnings) },
            Err(reason) => Self::from_scan(path, bytes, Some(&reason), warnings),
        };
        if let Some(Ok(Record::Header(header))) = Records::at(bytes, MAGIC.len() as u64).map(|r| r.parse()) {
            (index.profile, index.library) = (header.profile, header.library);
        }
        index.blocks.sort_by_key(|b| (b.start, b.offset));
        index
    }

    /// The index in the file, if there is one: all parts of a summary section are optional.
    ///
    /// # Errors
    /// Contradictions of the index to the records.
    fn from_summary(
        path: &Path,
        bytes: &[u8],
        warnings: &mut BTreeSet<Warning>,
    ) -> Result<Option<Self>, String> {
        let (footer, footer_at) = footer(bytes)?;
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
        let (mut counted, mut chunks) = (None, Chunks::new());
        for record in Records::new(&bytes[..footer_at], start) {
            let record = record.map_err(|at| format!("the summary section breaks off at byte {at}"))?;
            match record.parse()? {
                Record::Statistics(s) => counted = Some(s),
                Record::ChunkIndex(c) => {
                    let offset = usize::try_from(c.chunk_start_offset).unwrap_or(usize::MAX);
                    let end_offset =
                        offset.saturating_add(usize::try_from(c.chunk_length).unwrap_or(usize::MAX));
                    if end_offset > start {
                        return Err(format!("the chunk index points at byte {offset}, outside the data"));
                    }
                    let stated = (end_offset, c.message_start_time, c.message_end_time);
                    if chunks.insert(offset, stated).is_some() {
                        return Err(format!("two of its entries point at byte {offset}"));
                    }
                    index.compressions.insert(c.compression);
                    // A chunk without messages (schemas and channels) has no times, either.
                    let channels: BTreeSet<u16> = c.message_index_offsets.into_keys().collect();
                    let indexed = c.message_index_length > 0 || !channels.is_empty();
                    if indexed || c.message_end_time > 0 {
                        let (start, end) = (c.message_start_time, c.message_end_time);
                        let channels = indexed.then_some(channels);
                        index.blocks.push(Block { offset, end_offset, start, end, channels, is_chunk: true });
                    }
                }
                Record::AttachmentIndex(a) => {
                    index.attachments.push(Entry { offset: a.offset, name: a.name })
                }
                Record::MetadataIndex(m) => index.metadata.push(Entry { offset: m.offset, name: m.name }),
                other => index.declare(other)?,
            }
        }
        let Some(counted) = counted else { return Ok(None) };
        let data = Data::of(&bytes[..start]);
        if let Some(at) = data.broken {
            // The records behind it can only be reached by the index.
            let detail =
                "no complete record starts here; later ones can be reached by the index only".to_owned();
            let kind = WarningKind::Inconsistent;
            warnings.insert(Warning { path: path.to_owned(), offset: at as u64, kind, detail });
        } else if chunks.is_empty() && !data.chunks.is_empty() {
            return Ok(None);
        } else if let Some(wrong) = data.contradiction(&chunks, &counted) {
            return Err(wrong);
        }
        index.blocks.extend(data.loose);
        index.counts = counted.channel_message_counts;
        if index.counts.is_empty() {
            index.counts = data.counts;
        }
        let is_complete = index.counts.keys().all(|c| index.channels.contains_key(c))
            && index.counts.values().sum::<u64>() == counted.message_count;
        Ok(is_complete.then_some(index))
    }

    fn from_scan(path: &Path, bytes: &[u8], reason: Option<&str>, warnings: &mut BTreeSet<Warning>) -> Self {
        let (mut index, mut inside) = (Self::default(), Inside::default());
        let mut warn = |(offset, kind): (usize, WarningKind), detail: String| {
            warnings.insert(Warning { path: path.to_owned(), offset: offset as u64, kind, detail });
        };
        let end = walk(bytes, &mut |item| {
            match item {
                Walked::Record(record, _) if record.opcode == op::DATA_END => {
                    index.complete = true;
                    if let Some(reason) = reason {
                        warn((record.offset, WarningKind::NoIndex), reason.to_owned());
                    }
                }
                Walked::Record(record, chunk) => {
                    let messages = chunk.map(|_| &mut inside);
                    index.add(&record, messages).unwrap_or_else(|detail| warn(place(&record, chunk), detail));
                }
                Walked::ChunkEnd(chunk) => index.close(&chunk, std::mem::take(&mut inside)),
                Walked::Unreadable(at, kind, detail) => warn((at, kind), detail),
            }
            true
        });
        if !index.complete {
            let detail = match bytes.len().saturating_sub(end) {
                0 => "its end record is missing".to_owned(),
                left => format!("its last {left} bytes are an incomplete record"),
            };
            warn((end, WarningKind::Truncated), detail);
        }
        index
    }

    /// Adds a record outside chunks, or inside the open one.
    fn add(&mut self, record: &RawRecord<'_>, inside: Option<&mut Inside>) -> Result<(), String> {
        if [op::CHUNK, op::MESSAGE_INDEX].contains(&record.opcode) {
            return Ok(());
        }
        let offset = record.offset as u64;
        match (record.parse()?, inside) {
            (Record::Message { header, .. }, inside) => {
                if self.channels.contains_key(&header.channel_id) {
                    *self.counts.entry(header.channel_id).or_default() += 1;
                }
                match inside {
                    Some(inside) => inside.add(&header),
                    None => add_loose(&mut self.blocks, record, &header),
                }
            }
            (Record::Attachment { header, .. }, None) => {
                self.attachments.push(Entry { offset, name: header.name })
            }
            (Record::Metadata(m), None) => self.metadata.push(Entry { offset, name: m.name }),
            (other, _) => self.declare(other)?,
        }
        Ok(())
    }

    /// Adds a chunk after what is inside it.
    fn close(&mut self, chunk: &RawRecord<'_>, Inside { bounds, channels }: Inside) {
        if let Ok(Record::Chunk { header, .. }) = chunk.parse() {
            self.compressions.insert(header.compression);
        }
        if let Some((start, end)) = bounds {
            let (offset, end_offset, channels) = (chunk.offset, chunk.end(), Some(channels));
            self.blocks.push(Block { offset, end_offset, start, end, channels, is_chunk: true });
        }
    }

    /// Adds a schema or a channel; other records are ignored.
    fn declare(&mut self, record: Record<'_>) -> Result<(), String> {
        match record {
            Record::Schema { header, data } => {
                self.schemas.entry(header.id).or_insert((header, data.into_owned()));
            }
            Record::Channel(channel) => {
                let info = self.channel_info(&channel)?;
                self.channels.entry(channel.id).or_insert_with(|| Arc::new(info));
            }
            _ => {}
        }
        Ok(())
    }

    fn channel_info(&self, channel: &Channel) -> Result<ChannelInfo, String> {
        let (ros_type, schema_encoding, schema) = match channel.schema_id {
            0 => Default::default(),
            id => match self.schemas.get(&id) {
                Some((header, data)) => (header.name.clone(), header.encoding.clone(), data.clone()),
                None => {
                    return Err(format!("channel {} names schema {id}, which is missing", channel.topic));
                }
            },
        };
        let value = |key: &str| channel.metadata.get(key).cloned().unwrap_or_default();
        let (definition, type_hash) =
            (String::from_utf8_lossy(&schema).into_owned(), value("topic_type_hash"));
        Ok(ChannelInfo {
            topic: channel.topic.clone(),
            stored: StoredDefinition::of(&ros_type, &schema_encoding, &definition, &type_hash),
            ros_type,
            definition,
            schema,
            schema_encoding,
            message_encoding: channel.message_encoding.clone(),
            qos: value("offered_qos_profiles"),
            type_hash,
            metadata: channel.metadata.clone(),
        })
    }
}

/// The footer and its position, if the file is complete.
fn footer(bytes: &[u8]) -> Result<(Footer, usize), String> {
    const FOOTER: usize = FRAME + 20;
    let at = bytes
        .strip_suffix(MAGIC)
        .and_then(|b| b.len().checked_sub(FOOTER))
        .ok_or("the end magic is missing")?;
    match Records::at(bytes, at as u64).map(|r| (r.opcode, r.parse())) {
        Some((op::FOOTER, Ok(Record::Footer(footer)))) => Ok((footer, at)),
        _ => Err("there is no footer before the end magic".into()),
    }
}
