//! A complete check of a recording.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use grainlab_any_message::Schema;
use grainlab_console::count;
use mcap::records::{MessageHeader, MessageIndex, MessageIndexEntry, Record, op};
use serde::Serialize;

use super::channel::ChannelInfo;
use super::declarations::Declarations;
use super::definition::StoredDefinition;
use super::error::{Warning, WarningKind};
use super::file::OpenFile;
use super::messages::Selection;
use super::recording::Recording;
use super::records::{FRAME, RawRecord, is_misplaced, is_unknown, misplaced};
use super::walk::{Walked, place, walk};

/// The result of a complete check.
#[derive(Clone, Debug, Serialize)]
pub struct Check {
    /// Paths of the files.
    pub files: Vec<PathBuf>,
    /// Size of all files, bytes.
    pub bytes: u64,
    /// Records in them, those within chunks included.
    pub records: u64,
    /// Chunks, each with its checksum.
    pub chunks: u64,
    /// Messages in them.
    pub messages: u64,
    /// Number of stored files.
    pub attachments: u64,
    /// Checksums that are there, of chunks, stored files and the data.
    pub checksums: u64,
    /// Channels with a definition of ROS 2 that can be parsed.
    pub ros_definitions: usize,
    /// True if the index of a file is absent or lacks a part, which the format allows.
    pub without_index: bool,
    /// Number of all channels.
    pub all_definitions: usize,
    /// Lost messages according to the ledger of the recorders; `None` without a ledger.
    pub lost: Option<u64>,
    /// Why the recorder ended before the run did, as on a full disk; `None` if it did not.
    pub ended_early: Option<String>,
    /// Files without a ledger whose recorder was killed, had no room on the disk, or is still running.
    pub unaccounted: Vec<PathBuf>,
    /// Those of a killed recorder that were recovered, each with the parts that could not be read then.
    pub recovered: BTreeMap<PathBuf, Vec<Warning>>,
    /// Files that never had a ledger, copies and those of other programs: their losses cannot be judged.
    pub unjudged: Vec<PathBuf>,
    /// Topics whose definition is missing or not that of this program, with what differs.
    pub definitions: Vec<String>,
    /// True if messages of such a topic cannot be read by this program.
    pub refused: bool,
    /// Types of records below 0x80 that MCAP does not define, as far as this program knows: they are not read.
    pub unknown_records: BTreeSet<u8>,
    /// Faults in all files.
    pub warnings: Vec<Warning>,
}

impl Recording {
    /// Faults without those of the ledger: in a recovered file it also counts messages that are no longer readable.
    pub(crate) fn verify_files(&self) -> Vec<Warning> {
        Contents::of(self);
        self.warnings()
    }

    fn ros_definitions(&self) -> impl Iterator<Item = (&OpenFile, &Arc<ChannelInfo>)> {
        let all = self.files.iter().flat_map(|f| f.index.channels.values().map(move |c| (f, c)));
        all.filter(|(_, c)| c.schema_encoding == "ros2msg")
    }

    fn definition_faults(&self) -> Vec<(PathBuf, String)> {
        let fault = |(file, c): (&OpenFile, &Arc<ChannelInfo>)| {
            let why = Schema::parse(&c.ros_type, &c.definition).err()?;
            let detail = format!("{}: its definition of {} cannot be parsed: {why}", c.topic, c.ros_type);
            Some((file.path.clone(), detail))
        };
        self.ros_definitions().filter_map(fault).collect()
    }

    /// First message of each topic that does not decode by its definition.
    fn undecodable(&self) -> BTreeMap<String, String> {
        let (mut schemas, mut wrong) = (BTreeMap::new(), BTreeMap::new());
        for message in self.messages(&Selection::default()).into_iter().flatten() {
            let c = &message.channel;
            let parsed = || {
                let is_known =
                    (c.schema_encoding.as_str(), c.message_encoding.as_str()) == ("ros2msg", "cdr");
                Schema::parse(&c.ros_type, &c.definition).ok().filter(|_| is_known)
            };
            let schema = schemas.entry(Arc::as_ptr(c).addr()).or_insert_with(parsed);
            if let Some(Err(e)) = schema.as_ref().map(|schema| schema.decode(&message.payload)) {
                let new =
                    || format!("{}: its message of {} ns does not decode: {e}", c.topic, message.log_time);
                wrong.entry(c.topic.clone()).or_insert_with(new);
            }
        }
        wrong
    }

    /// Reads all data: counts, and all faults: checksums, the index against the messages, log times that decrease, the messages against their definitions, and the ledger
    /// against the messages.
    pub fn check(&self) -> Check {
        let found = Contents::of(self);
        let contradiction = |path: &Path, detail| {
            self.warn(Warning::of_file(path.to_owned(), WarningKind::Inconsistent, detail))
        };
        let ledger = self.ledger();
        let unaccounted = self.unaccounted();
        if let Some(ledger) = ledger.as_ref().filter(|_| unaccounted.is_empty()) {
            for topic in ledger {
                let there = found.by_topic.get(&topic.name).copied().unwrap_or(0);
                if topic.recorded != there {
                    let (recorded, name) = (count(topic.recorded, "message"), &topic.name);
                    let detail =
                        format!("the ledger lists {recorded} as recorded on {name}, the files hold {there}");
                    contradiction(self.path(), detail);
                }
            }
        }
        for detail in self.undecodable().into_values() {
            contradiction(self.path(), detail);
        }
        let definitions = self.definition_faults();
        let bag = self.bag.as_ref().filter(|_| self.path().is_dir());
        for detail in bag.map(|bag| bag.differences(self, &found)).unwrap_or_default() {
            contradiction(&self.path().join("metadata.yaml"), detail);
        }
        for (path, detail) in &definitions {
            contradiction(path, detail.clone());
        }
        let recovered = self.recovered();
        let unaccounted = unaccounted.into_iter().filter(|path| !recovered.contains_key(path)).collect();
        Check {
            files: self.paths(),
            bytes: self.size(),
            records: found.records,
            chunks: found.chunks,
            messages: found.messages,
            attachments: found.attachments,
            checksums: found.checksums,
            ros_definitions: self.ros_definitions().count() - definitions.len(),
            without_index: self.is_without_index(),
            all_definitions: self.all_channels().count(),
            lost: ledger.map(|l| l.iter().map(|t| t.lost).fold(0, u64::saturating_add)),
            ended_early: self.ended_early(),
            unaccounted,
            recovered,
            unjudged: self.unjudged(),
            definitions: self.definitions(),
            refused: self.all_channels().any(|c| matches!(c.stored, StoredDefinition::Refused(_))),
            unknown_records: found.unknown,
            warnings: self.warnings(),
        }
    }
}

#[derive(Default)]
pub(super) struct Contents {
    records: u64,
    chunks: u64,
    pub(super) messages: u64,
    attachments: u64,
    checksums: u64,
    unknown: BTreeSet<u8>,
    pub(super) by_topic: BTreeMap<String, u64>,
    /// Lowest log time.
    pub(super) first: Option<u64>,
    /// Longest time from the lowest log time before a message to that of the message.
    pub(super) longest: u64,
    /// Highest log time of the files before, and of this one.
    pub(super) last: u64,
    last_of_file: Option<u64>,
}

impl Contents {
    fn of(recording: &Recording) -> Self {
        let mut found = Self::default();
        for file in &recording.files {
            found.last_of_file = None;
            found.file(file, &mut |w| recording.warn(w));
        }
        found
    }

    /// Reports everything in `file` that is damaged or contradicts its index.
    fn file(&mut self, file: &OpenFile, warn: &mut dyn FnMut(Warning)) {
        let mut counts = BTreeMap::<u16, u64>::new();
        let (mut chunks, mut ended) = (BTreeSet::new(), false);
        let (mut listed, mut order) = (Listed::default(), Order::default());
        walk(file.bytes(), &mut |item| {
            match item {
                Walked::Record(record, chunk) => {
                    self.records += 1;
                    let at = chunk.unwrap_or(record.offset);
                    match (record.opcode, chunk) {
                        (op::MESSAGE, _) => {
                            self.message(file, &record, at, &mut counts, warn);
                            order.message(file, &record, at);
                            listed.message(&record);
                        }
                        (op::SCHEMA | op::CHANNEL, _) => match record.parse() {
                            Ok(parsed) => {
                                let fault = order.declare(file, parsed).or_else(|| record.repeated_key());
                                let new = |detail| file.warning(at, WarningKind::Inconsistent, detail);
                                fault.map(new).into_iter().for_each(&mut *warn);
                            }
                            Err(detail) => {
                                let (at, kind) = place(&record, chunk);
                                warn(file.warning(at, kind, detail));
                            }
                        },
                        (opcode, Some(_)) if is_misplaced(opcode) => {
                            warn(file.warning(at, WarningKind::Inconsistent, misplaced(opcode)));
                        }
                        (opcode @ ..0x80, _) if is_unknown(opcode) => _ = self.unknown.insert(opcode),
                        (op::CHUNK, None) => {
                            chunks.insert(record.offset);
                            listed = Listed::default();
                        }
                        (op::DATA_END, None) => {
                            ended = true;
                            self.checksums += u64::from(record.body.iter().any(|byte| *byte != 0));
                            data_checksum(file, &record).into_iter().for_each(&mut *warn);
                        }
                        (_, None) => match record.parse() {
                            Ok(Record::MessageIndex(index)) => {
                                if let Some(detail) = listed.wrong(&index) {
                                    warn(file.warning(record.offset, WarningKind::Inconsistent, detail));
                                }
                            }
                            Ok(Record::Attachment { crc, .. }) => {
                                self.attachments += 1;
                                self.checksums += u64::from(crc != 0);
                            }
                            Ok(_) => {}
                            Err(detail) => {
                                warn(file.warning(record.offset, WarningKind::DamagedRecord, detail))
                            }
                        },
                        _ => {}
                    }
                }
                Walked::ChunkEnd(chunk) => {
                    self.chunks += 1;
                    if let Ok(Record::Chunk { header, .. }) = chunk.parse() {
                        self.checksums += u64::from(header.uncompressed_crc != 0);
                    }
                    if let Some(detail) = listed.outside(&chunk) {
                        warn(file.warning(chunk.offset, WarningKind::Inconsistent, detail));
                    }
                }
                Walked::Unreadable(at, kind, detail) => {
                    order.is_broken = true;
                    warn(file.warning(at, kind, detail));
                }
            }
            true
        });
        for (at, detail) in order.early(file) {
            warn(file.warning(at, WarningKind::Inconsistent, detail));
        }
        self.last = self.last.max(self.last_of_file.unwrap_or(0));
        if ended || !file.index.complete {
            against_index(file, counts, &chunks, warn);
        }
    }

    fn message(
        &mut self,
        file: &OpenFile,
        record: &RawRecord<'_>,
        at: usize,
        counts: &mut BTreeMap<u16, u64>,
        warn: &mut dyn FnMut(Warning),
    ) {
        let Some((header, _)) = record.message() else { return };
        self.messages += 1;
        *counts.entry(header.channel_id).or_default() += 1;
        if let Some(channel) = file.index.channels.get(&header.channel_id) {
            *self.by_topic.entry(channel.topic.clone()).or_default() += 1;
        }
        // Within a file the messages of several publishers may come in any order (rosbag2 allows it); files follow
        // each other.
        if self.last_of_file.is_none() && header.log_time < self.last {
            let detail = "it begins before the end of the previous file".to_owned();
            warn(file.warning(at, WarningKind::Inconsistent, detail));
        }
        let first = self.first.map_or(header.log_time, |first| first.min(header.log_time));
        self.first = Some(first);
        self.longest = self.longest.max(header.log_time - first);
        self.last_of_file = Some(self.last_of_file.map_or(header.log_time, |t| t.max(header.log_time)));
    }
}

/// Order of declarations and messages: MCAP demands a schema before its channels, and a channel before its messages.
#[derive(Default)]
struct Order {
    declared: Declarations,
    /// Messages before their channel: the byte of the first, and their number.
    early: BTreeMap<u16, (usize, u64)>,
    /// True once a part could not be read, which may have contained declarations.
    is_broken: bool,
}

impl Order {
    /// Adds a schema or a channel; returns what MCAP forbids of it.
    fn declare(&mut self, file: &OpenFile, record: Record<'_>) -> Option<String> {
        let fault = match &record {
            Record::Schema { header, .. } if header.id == 0 => {
                Some(format!("schema {:?} has the id 0, which MCAP forbids; it is ignored", header.name))
            }
            Record::Channel(channel) if !self.is_broken => {
                let (topic, schema) = (&channel.topic, channel.schema_id);
                let is_late = !self.declared.has_schema(schema) && file.index.declared.has_schema(schema);
                is_late.then(|| {
                    format!("channel {topic:?} comes before its schema {schema}, which MCAP forbids")
                })
            }
            _ => None,
        };
        let difference = self.declared.add(record).err();
        fault.or(difference)
    }

    fn message(&mut self, file: &OpenFile, record: &RawRecord<'_>, at: usize) {
        let Some((header, _)) = record.message().filter(|_| !self.is_broken) else { return };
        let id = header.channel_id;
        if !self.declared.has_channel(id) && file.index.channels.contains_key(&id) {
            self.early.entry(id).or_insert((at, 0)).1 += 1;
        }
    }

    /// Returns the byte of the first message before its channel, for each channel, and a sentence.
    fn early(&self, file: &OpenFile) -> impl Iterator<Item = (usize, String)> {
        self.early.iter().map(|(id, (at, number))| {
            let topic = &file.index.channels[id].topic;
            let messages = count(*number, "message");
            (*at, format!("{messages} on {topic} before the declaration of its channel, which MCAP forbids"))
        })
    }
}

/// The messages of the last chunk: channel, log time, and place in its content.
#[derive(Default)]
struct Listed(BTreeSet<(u16, u64, u64)>);

impl Listed {
    fn message(&mut self, record: &RawRecord<'_>) {
        let key =
            |(header, _): (MessageHeader, _)| (header.channel_id, header.log_time, record.offset as u64);
        self.0.extend(record.message().map(key));
    }

    fn outside(&self, chunk: &RawRecord<'_>) -> Option<String> {
        let Ok(Record::Chunk { header, .. }) = chunk.parse() else { return None };
        let times = || self.0.iter().map(|(_, time, _)| *time);
        let (first, last) = (times().min()?, times().max()?);
        let stated = (header.message_start_time, header.message_end_time);
        let text = || {
            let (begin, end) = stated;
            format!("its chunk has messages from {first} to {last} ns, its header states {begin} to {end} ns")
        };
        (stated != (first, last)).then(text)
    }

    /// The difference between the messages of a channel and the list of them behind the chunk.
    fn wrong(&self, index: &MessageIndex) -> Option<String> {
        let of = |entry: &MessageIndexEntry| (index.channel_id, entry.log_time, entry.offset);
        let listed: BTreeSet<_> = index.records.iter().map(of).collect();
        let channel = index.channel_id;
        let there = self.0.range((channel, 0, 0)..=(channel, u64::MAX, u64::MAX)).copied().collect();
        let text = || format!("the list of messages on channel {channel} is not that of the chunk before it");
        (!self.0.is_empty() && listed != there).then(text)
    }
}

fn against_index(
    file: &OpenFile,
    mut counts: BTreeMap<u16, u64>,
    chunks: &BTreeSet<usize>,
    warn: &mut dyn FnMut(Warning),
) {
    for block in file.index.blocks.iter().filter(|b| b.is_chunk && !chunks.contains(&b.offset)) {
        let detail = "the index has a chunk here, but there is none".to_owned();
        warn(file.warning(block.offset, WarningKind::Inconsistent, detail));
    }
    counts.retain(|channel, _| file.index.channels.contains_key(channel));
    for (channel, info) in &file.index.channels {
        let claimed = file.index.counts.get(channel).copied().unwrap_or(0);
        let found = counts.get(channel).copied().unwrap_or(0);
        if claimed != found {
            let detail = format!(
                "the index counts {} on {}, the file holds {found}",
                count(claimed, "message"),
                info.topic
            );
            warn(file.warning(file.bytes().len(), WarningKind::Inconsistent, detail));
        }
    }
}

fn data_checksum(file: &OpenFile, end: &RawRecord<'_>) -> Option<Warning> {
    let wrong = |detail| Some(file.warning(end.offset, WarningKind::Inconsistent, detail));
    let Ok(Record::DataEnd(claimed)) = end.parse() else {
        return wrong(format!("the end record has {} bytes", end.body.len() + FRAME));
    };
    let (crc, claimed) = (crc32fast::hash(&file.bytes()[..end.offset]), claimed.data_section_crc);
    // 0 means "not computed".
    if claimed == 0 || claimed == crc {
        return None;
    }
    wrong(format!("the checksum of the whole data is {crc:08x}, not {claimed:08x}: bytes were altered"))
}
