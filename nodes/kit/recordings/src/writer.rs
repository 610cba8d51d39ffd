//! Writes a run directory; a crash loses at most the open chunk.
//!
//! The files follow rosbag2: profile `ros2`, schemas `ros2msg`, messages in CDR with their encapsulation
//! header, QoS and type hash in the channel's metadata. Chunks are built in memory and written whole, with
//! their CRC. A chunk that is not empty is closed after [`WriterOptions::flush_interval`] at the latest, so
//! that the data on disk are a valid prefix at any time. Another thread syncs the file to the device about
//! once a second.
//!
//! A long run is split into files `<name>_0.mcap`, `<name>_1.mcap` … as rosbag2 does, since the index of a file is kept
//! in memory until its end. Each part declares all topics and holds the counts so far; log times increase over
//! all of them.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

use mcap::records::Metadata;
use mcap::{Attachment, McapError};

use crate::bag_metadata::{BagMetadata, TopicCount};
use crate::failures::{cannot, reason};
use crate::ledger::Ledger;
use crate::metadata_keys::{ENDED_BY_KEY, LEDGER_KEY, METADATA_RECORD, SESSION_KEY};
use crate::reader::Recording;
use grainlab_console::Failure;
use grainlab_msgs::Guid;

mod counted;
mod device_sync;
mod names;
mod options;
pub(crate) mod part;
mod space;
mod topic_spec;

pub(crate) use names::is_locked;
pub use names::recording_in;
use names::{next_number, part_path, refuse_recording, session};
pub use options::WriterOptions;
use part::Part;
use space::free_space;
pub use topic_spec::TopicSpec;

/// A sample received from the network.
#[derive(Clone, Copy, Debug)]
pub struct Incoming<'a> {
    /// Writer of the sample.
    pub guid: Guid,
    /// RTPS sequence number, counted from 1 by each writer.
    pub sequence: i64,
    /// Source time, ns since 1970, if known.
    pub source_time: Option<u64>,
    /// Time of arrival, ns since 1970.
    pub receive_time: u64,
    /// CDR with its 4-byte encapsulation header.
    pub payload: &'a [u8],
}

/// The result for one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It was recorded.
    Recorded {
        /// Log time, ns since 1970, strictly increasing over the recording.
        log_time: u64,
    },
    /// It was recorded before: counted, and not written again.
    Repeated,
}

/// The summary of a finished recording.
#[derive(Clone, Debug)]
pub struct Finished {
    /// The last MCAP file.
    pub file: PathBuf,
    /// All MCAP files of this writer, in order.
    pub files: Vec<PathBuf>,
    /// Size of all files, bytes.
    pub bytes: u64,
    /// Messages in them.
    pub messages: u64,
    /// The counts of all topics.
    pub ledger: Ledger,
}

/// Writes one run. Call [`RunWriter::tick`] at least every 100 ms and [`RunWriter::finish`] at the end; a
/// writer that is dropped instead completes its file if possible and marks it `finished = false`.
pub struct RunWriter {
    directory: PathBuf,
    name: String,
    /// Number of the file being written.
    number: u64,
    file: PathBuf,
    options: WriterOptions,
    /// `None` only after the end.
    part: Option<Part>,
    /// The topics, and the files that are complete, those of earlier writers included.
    bag: BagMetadata,
    /// Topics of this writer; earlier ones may have had others.
    topics: BTreeSet<String>,
    /// Files of this writer that are complete, and their size.
    files: Vec<PathBuf>,
    bytes: u64,
    messages: u64,
    ledger: Ledger,
    /// Last log time of all.
    last: Option<u64>,
    /// Time by which the clock was set back between the earlier writers and this one, ns. Known from the first message on.
    set_back: Option<u64>,
    /// Time of the oldest unwritten message.
    pending: Option<Instant>,
    /// Payload bytes since the last check of free space.
    unchecked: u64,
    ended: Option<String>,
    metadata: BTreeMap<String, String>,
}

/// Payload bytes after which free space is checked again, whatever the time.
const CHECK_EVERY: u64 = 1 << 20;

impl RunWriter {
    /// Begins `<directory>/<name>_0.mcap` with these topics; creates the directory if necessary. For rosbag2,
    /// `name` should be that of the directory.
    ///
    /// # Errors
    /// Returns wrong usage if the directory holds a recording, and an error if space is short or the file system fails.
    pub fn create(
        directory: &Path,
        name: &str,
        topics: &[TopicSpec],
        options: WriterOptions,
    ) -> Result<Self, Failure> {
        refuse_recording(directory)?;
        Self::begin(directory, name, topics, options, 0, BagMetadata::default())
    }

    /// Continues a run: begins `<directory>/<name>_<n>.mcap`, with the next free number. Existing files are
    /// unchanged; log times continue after theirs, and `metadata.yaml` will list all files. Topics of an earlier
    /// version have the definitions of this one in the new file. The file of a recorder that was killed should be
    /// [recovered](crate::recover()) before, or other tools cannot read the run. If nothing of the run was
    /// recorded, it begins again.
    ///
    /// # Errors
    /// If a file of the run is being recorded, a topic contradicts an existing one, or as
    /// [`RunWriter::create`].
    pub fn append(
        directory: &Path,
        name: &str,
        topics: &[TopicSpec],
        options: WriterOptions,
    ) -> Result<Self, Failure> {
        let recording = Recording::open(directory).ok();
        // Without a recording, files without a byte hold nothing that a reader could miss.
        let number = next_number(directory, name, recording.is_none())?;
        let before = recording.as_ref().map_or_else(BagMetadata::default, BagMetadata::of);
        Self::begin(directory, name, topics, options, number, before)
    }

    fn begin(
        directory: &Path,
        name: &str,
        topics: &[TopicSpec],
        options: WriterOptions,
        number: u64,
        before: BagMetadata,
    ) -> Result<Self, Failure> {
        fs::create_dir_all(directory).map_err(cannot(directory, "create the directory"))?;
        let file = part_path(directory, name, number);
        let free = free_space(directory).map_err(cannot(directory, "query the free space"))?;
        if free < options.free_to_start {
            return Err(no_space(&file, free, options.free_to_start, "not begun"));
        }
        let part = Part::create(file.clone(), &options, Instant::now())?;
        let mut writer = Self {
            directory: directory.to_owned(),
            name: name.to_owned(),
            number,
            file,
            options,
            part: Some(part),
            last: before.bounds().map(|(_, last)| last),
            set_back: None,
            bag: before,
            topics: BTreeSet::new(),
            files: Vec::new(),
            bytes: 0,
            messages: 0,
            ledger: Ledger::default(),
            pending: None,
            unchecked: 0,
            ended: None,
            metadata: BTreeMap::from([(SESSION_KEY.to_owned(), session())]),
        };
        for topic in topics {
            writer.declare(topic)?;
        }
        // Schemas are written once: if they were lost with the first chunk, no later message could be
        // decoded.
        writer.flush()?;
        Ok(writer)
    }

    /// Declares a topic while the recording runs, and writes it to the file at once.
    ///
    /// # Errors
    /// If the topic exists with another type, schema or QoS, or the file cannot be written.
    pub fn add_topic(&mut self, topic: &TopicSpec) -> Result<(), Failure> {
        self.declare(topic)?;
        self.flush()
    }

    fn declare(&mut self, topic: &TopicSpec) -> Result<(), Failure> {
        if let Some(known) = self.bag.topics.get(&topic.name) {
            let is_own = self.topics.contains(&topic.name);
            if known.spec != *topic && (is_own || !topic.continues(&known.spec)) {
                return Err(Failure::failed(format!(
                    "topic {} is already recorded with another type, schema or QoS",
                    topic.name
                )));
            }
            if is_own {
                return Ok(());
            }
        }
        self.with("declare a topic", topic.definition.len(), |part| part.declare(topic))?;
        self.ledger.expect(&topic.name);
        self.topics.insert(topic.name.clone());
        let messages = self.bag.topics.get(&topic.name).map_or(0, |known| known.messages);
        self.bag.topics.insert(topic.name.clone(), TopicCount { spec: topic.clone(), messages });
        Ok(())
    }

    /// Records a sample. Its log time is the time of arrival, increased if necessary to be later than the
    /// last one and not earlier than the source time; its `sequence` is the low half of the RTPS sequence
    /// number. If the clock was set back since an earlier writer of the run, the times of arrival go on from
    /// the last log time, so that the intervals between messages are kept.
    ///
    /// # Errors
    /// If the topic was not declared, the sample is not CDR, or the recording has ended (disk full, write
    /// failure).
    pub fn write(&mut self, topic: &str, sample: &Incoming<'_>) -> Result<Outcome, Failure> {
        if !self.topics.contains(topic) {
            return Err(Failure::failed(format!(
                "topic {topic} was not declared to the recording: add it with its type before its first message"
            )));
        }
        if sample.payload.len() < 4 {
            return Err(Failure::failed(format!(
                "message {} on {topic} has {} bytes: CDR starts with a 4-byte encapsulation header",
                sample.sequence,
                sample.payload.len()
            )));
        }
        if self.ledger.holds(topic, &sample.guid, sample.sequence) {
            self.ledger.enter(topic, sample.guid, sample.sequence);
            return Ok(Outcome::Repeated);
        }
        let after = self.last.map_or(0, |last| last.saturating_add(1));
        let set_back = *self.set_back.get_or_insert(after.saturating_sub(sample.receive_time));
        let log_time = sample.receive_time.saturating_add(set_back).max(after);
        let publish_time = sample.source_time.unwrap_or(log_time).min(log_time);
        let sequence = sample.sequence as u32;
        self.with("write a message", sample.payload.len(), |part| {
            part.write(topic, sequence, log_time, publish_time, sample.payload)
        })?;
        self.ledger.enter(topic, sample.guid, sample.sequence);
        if let Some(t) = self.bag.topics.get_mut(topic) {
            t.messages += 1;
        }
        self.messages += 1;
        self.last = Some(log_time);
        let now = Instant::now();
        self.pending.get_or_insert(now);
        self.unchecked += sample.payload.len() as u64;
        if self.unchecked >= CHECK_EVERY {
            self.require_space()?;
        }
        // The file grew by a chunk just now, or not at all.
        if self.part.as_ref().is_some_and(|part| part.bytes() >= self.options.split_bytes) {
            self.split_if_due(now)?;
        }
        self.tick(now)?;
        Ok(Outcome::Recorded { log_time })
    }

    /// Writes the open chunk if its oldest message is older than the flush interval, requests a sync of the
    /// file to the device from time to time, and begins the next file when this one is long enough. Cheap if
    /// there is nothing to do.
    ///
    /// # Errors
    /// If the file cannot be written, or a sync failed.
    pub fn tick(&mut self, now: Instant) -> Result<(), Failure> {
        if self
            .pending
            .is_some_and(|since| now.saturating_duration_since(since) >= self.options.flush_interval)
        {
            self.flush()?;
            self.require_space()?;
            self.split_if_due(now)?;
        }
        let Some(part) = self.part.as_mut() else { return Ok(()) };
        part.sync.request(now, self.options.sync_interval);
        match part.sync.failure() {
            Some(source) => {
                let error = cannot(&self.file, "sync the recording to the device")(source);
                self.ended = Some(error.to_string());
                Err(error)
            }
            None => Ok(()),
        }
    }

    /// Stores a file in the recording (scene, launch file, parameters) and writes it at once.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn attach(&mut self, name: &str, media_type: &str, bytes: &[u8]) -> Result<(), Failure> {
        let time =
            SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.as_nanos() as u64);
        let attachment = Attachment {
            log_time: time,
            create_time: time,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: Cow::Borrowed(bytes),
        };
        self.with("attach a file", bytes.len(), |part| part.attach(&attachment))?;
        self.flush()
    }

    /// Sets a key of the metadata record at the end of every file.
    pub fn set_metadata(&mut self, key: &str, value: &str) {
        self.metadata.insert(key.to_owned(), value.to_owned());
    }

    /// The ledger so far.
    pub fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// The ledger, to add reports and names of writers.
    pub fn ledger_mut(&mut self) -> &mut Ledger {
        &mut self.ledger
    }

    /// The file being written.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Writes the ledger, the indexes and `metadata.yaml`, and returns when all of it is on the device. It
    /// also works on a disk that is full. After a write failure it returns the error, and the data written
    /// before stay readable.
    ///
    /// # Errors
    /// If the recording cannot be completed. It then has no `metadata.yaml`.
    pub fn finish(mut self) -> Result<Finished, Failure> {
        self.close(true)
    }

    fn close(&mut self, finished: bool) -> Result<Finished, Failure> {
        self.close_part(if finished { "true" } else { "false" })?;
        self.bag.write(&self.directory).map_err(cannot(&self.file, "write metadata.yaml"))?;
        Ok(Finished {
            file: self.file.clone(),
            files: std::mem::take(&mut self.files),
            bytes: self.bytes,
            messages: self.messages,
            ledger: std::mem::take(&mut self.ledger),
        })
    }

    fn close_part(&mut self, finished: &str) -> Result<(), Failure> {
        let Some(part) = self.part.take() else {
            return Err(self.already_ended());
        };
        let mut metadata = self.metadata.clone();
        metadata.insert("finished".into(), finished.into());
        if let Some(reason) = &self.ended {
            metadata.insert(ENDED_BY_KEY.into(), reason.clone());
        }
        let tallies = serde_json::to_string(&self.ledger.tallies())
            .map_err(cannot(&self.file, "write the ledger as JSON"))?;
        metadata.insert(LEDGER_KEY.into(), tallies);
        let closed = match part.close(Metadata { name: METADATA_RECORD.into(), metadata }) {
            Ok(closed) => closed,
            // After a failed write the MCAP writer only reports that it failed; the reason is the first
            // error.
            Err(_) if self.ended.is_some() => return Err(self.already_ended()),
            Err(error) => return Err(error),
        };
        self.bytes += closed.bytes;
        self.files.push(closed.path);
        self.bag.files.push(closed.count);
        Ok(())
    }

    fn split_if_due(&mut self, now: Instant) -> Result<(), Failure> {
        let Some(part) = self.part.as_ref().filter(|part| part.has_messages()) else { return Ok(()) };
        let old = now.saturating_duration_since(part.began()) >= self.options.split_after;
        if !old && part.bytes() < self.options.split_bytes {
            return Ok(());
        }
        let file = part_path(&self.directory, &self.name, self.number + 1);
        // Begun before this file is completed, which needs room for the end of this file alone if the next one has none.
        let split = self.next_part(file.clone(), now).and_then(|next| {
            self.close_part("continued")?;
            (self.number, self.file, self.part) = (self.number + 1, file, Some(next));
            self.pending = None;
            Ok(())
        });
        split.inspect_err(|error| self.ended = Some(error.to_string()))
    }

    fn next_part(&self, file: PathBuf, now: Instant) -> Result<Part, Failure> {
        let mut next = Part::create(file.clone(), &self.options, now)?;
        let specs = self.topics.iter().filter_map(|name| self.bag.topics.get(name)).map(|topic| &topic.spec);
        let declared = next
            .reserve(specs.clone().map(|spec| spec.definition.len()).sum())
            .and_then(|()| specs.clone().try_for_each(|spec| next.declare(spec)))
            .and_then(|()| next.flush());
        declared.map(|()| next).map_err(|e| {
            let _ = fs::remove_file(&file);
            cannot(&file, "begin the file")(described(e))
        })
    }

    fn flush(&mut self) -> Result<(), Failure> {
        self.with("write a chunk", 0, Part::flush)?;
        self.pending = None;
        Ok(())
    }

    fn require_space(&mut self) -> Result<(), Failure> {
        self.unchecked = 0;
        let free = free_space(&self.directory).map_err(cannot(&self.directory, "query the free space"))?;
        if free >= self.options.free_to_continue {
            return Ok(());
        }
        let state = "stopped (what is recorded stays readable)";
        let error = no_space(&self.file, free, self.options.free_to_continue, state);
        self.ended = Some(error.to_string());
        Err(error)
    }

    /// Runs `action`, which adds at most `bytes` and a chunk, unless the recording has ended; a failure ends it.
    fn with<T>(
        &mut self,
        what: &'static str,
        bytes: usize,
        action: impl FnOnce(&mut Part) -> Result<T, McapError>,
    ) -> Result<T, Failure> {
        let Some(part) = self.part.as_mut().filter(|_| self.ended.is_none()) else {
            return Err(self.already_ended());
        };
        part.reserve(bytes).and_then(|()| action(part)).map_err(|source| {
            let error = cannot(&self.file, what)(described(source));
            self.ended = Some(error.to_string());
            error
        })
    }

    fn already_ended(&self) -> Failure {
        let (path, reason) = (self.file.display(), self.ended.as_deref().unwrap_or("it was finished"));
        Failure::failed(format!("{path}: an earlier error ended this recording: {reason}"))
    }
}

fn described(error: McapError) -> String {
    let is_full = matches!(&error, McapError::Io(e) if matches!(e.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded));
    let advice = if is_full { ": free space and run again" } else { "" };
    format!("{}; what was written before stays readable{advice}", reason(error))
}

fn no_space(path: &Path, free: u64, needed: u64, state: &str) -> Failure {
    Failure::failed(format!(
        "{}: only {free} bytes are free on this file system and {needed} are needed; the recording was {state}: free space \
         and run again",
        path.display()
    ))
}

impl Drop for RunWriter {
    fn drop(&mut self) {
        // No caller is left for an error; readers find the missing end of the file and of metadata.yaml.
        if self.part.is_some() {
            let _ = self.close(false);
        }
    }
}
