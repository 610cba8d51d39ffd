//! A run directory, written so that a crash costs the open chunk at most.
//!
//! The file follows rosbag2: profile `ros2`, schemas `ros2msg`, messages in CDR with their encapsulation
//! header, QoS and type hash in the channel's metadata. Chunks are built in memory and written whole, with
//! their CRC; a chunk that is not empty is closed at the latest after [`WriterOptions::flush_interval`]. So
//! what is on disk is at every moment a clean prefix, which [`crate::reader`] reads. A file is pushed to the
//! device about once a second from another thread.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, Compression, McapError, WriteOptions};

use crate::ledger::{Guid, Ledger};
use crate::{LEDGER_KEY, METADATA_RECORD};

mod bag_metadata;
mod device_sync;
mod error;
mod free_space;
mod topic_spec;

use bag_metadata::{BagMetadata, TopicCount};
use device_sync::DeviceSync;
pub use error::WriteError;
pub use free_space::free_space;
pub use topic_spec::TopicSpec;

/// A sample as it came from the network.
#[derive(Clone, Copy, Debug)]
pub struct Incoming<'a> {
    /// Who wrote it.
    pub guid: Guid,
    /// RTPS sequence number, counted from 1 by each writer.
    pub sequence: i64,
    /// Time of writing, ns since 1970; `None` if the writer did not say.
    pub source_time: Option<u64>,
    /// Time of arrival, ns since 1970.
    pub receive_time: u64,
    /// CDR with its 4-byte encapsulation header.
    pub payload: &'a [u8],
}

/// What became of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It is in the recording, at this log time (ns since 1970).
    Recorded {
        /// Strictly increasing over the recording.
        log_time: u64,
    },
    /// It was recorded before: counted, not written again.
    Repeated,
}

/// How a recording is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WriterOptions {
    /// Uncompressed bytes after which a chunk is closed.
    pub chunk_size: u64,
    /// Age of the oldest message at which an open chunk is closed and handed to the system.
    /// [`RunWriter::tick`] must be called often enough for the sum to stay below what a crash may cost.
    pub flush_interval: Duration,
    /// Time between two pushes to the device.
    pub sync_interval: Duration,
    /// Bytes that must be free to begin.
    pub free_to_start: u64,
    /// Bytes that must stay free: below, the recording ends in good order while it still can.
    pub free_to_continue: u64,
}

impl Default for WriterOptions {
    fn default() -> Self {
        Self {
            chunk_size: 768 << 10,
            flush_interval: Duration::from_millis(400),
            sync_interval: Duration::from_secs(1),
            free_to_start: 64 << 20,
            free_to_continue: 32 << 20,
        }
    }
}

/// What a finished recording is.
#[derive(Clone, Debug)]
pub struct Finished {
    /// The MCAP file.
    pub file: PathBuf,
    /// Its size, bytes.
    pub bytes: u64,
    /// Messages in it.
    pub messages: u64,
    /// First log time, ns since 1970; 0 without messages.
    pub start: u64,
    /// Last log time, ns since 1970; 0 without messages.
    pub end: u64,
    /// The account.
    pub ledger: Ledger,
}

struct Channel {
    spec: TopicSpec,
    channel: u16,
    messages: u64,
}

/// Writes one run. Call [`RunWriter::tick`] at least every 100 ms and [`RunWriter::finish`] at the end; a
/// writer that is dropped instead finishes its file as well as it can and marks it `finished = false`.
pub struct RunWriter {
    directory: PathBuf,
    file: PathBuf,
    options: WriterOptions,
    /// `None` only after the end.
    mcap: Option<mcap::Writer<BufWriter<File>>>,
    sync: DeviceSync,
    topics: BTreeMap<String, Channel>,
    ledger: Ledger,
    /// First and last log time.
    bounds: Option<(u64, u64)>,
    /// Since when an unwritten message waits.
    pending: Option<Instant>,
    /// Payload bytes since free space was last looked at.
    unchecked: u64,
    ended: Option<String>,
    metadata: BTreeMap<String, String>,
}

/// Payload bytes after which free space is looked at again, whatever the clock says.
const CHECK_EVERY: u64 = 1 << 20;

impl RunWriter {
    /// Begins `<directory>/<name>_0.mcap` with these topics; the directory is made if need be. For rosbag2,
    /// `name` should be the directory's own name.
    ///
    /// # Errors
    /// If the file exists, space is short, or the file system refuses.
    pub fn create(
        directory: &Path,
        name: &str,
        topics: &[TopicSpec],
        options: WriterOptions,
    ) -> Result<Self, WriteError> {
        let io = |path: &Path, action: &'static str| {
            let path = path.to_owned();
            move |source| WriteError::Io { path, action, source }
        };
        fs::create_dir_all(directory).map_err(io(directory, "make the directory"))?;
        let file = directory.join(format!("{name}_0.mcap"));
        let free = free_space(directory).map_err(io(directory, "ask for free space"))?;
        if free < options.free_to_start {
            let needed = options.free_to_start;
            return Err(WriteError::NoSpace { path: file, free, needed, state: "not begun" });
        }
        let handle = match File::create_new(&file) {
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {
                return Err(WriteError::Exists { path: file });
            }
            other => other.map_err(io(&file, "create the file"))?,
        };
        let sync = DeviceSync::start(handle.try_clone().map_err(io(&file, "duplicate the handle"))?)
            .map_err(io(&file, "start the thread that pushes data to the device"))?;
        // disable_seeking: a chunk is written whole with its true header, so a crash leaves a clean prefix.
        let mcap = WriteOptions::new()
            .profile("ros2")
            .library(concat!("grainlab ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Zstd))
            .compression_level(1)
            .compression_threads(0)
            .chunk_size(Some(options.chunk_size))
            .disable_seeking(true)
            .create(BufWriter::with_capacity(64 << 10, handle))
            .map_err(|source| WriteError::Format {
                path: file.clone(),
                action: "write the header",
                source,
            })?;
        let mut writer = Self {
            directory: directory.to_owned(),
            file,
            options,
            mcap: Some(mcap),
            sync,
            topics: BTreeMap::new(),
            ledger: Ledger::default(),
            bounds: None,
            pending: None,
            unchecked: 0,
            ended: None,
            metadata: BTreeMap::new(),
        };
        for topic in topics {
            writer.declare(topic)?;
        }
        // Schemas are written once: were they lost with the first chunk, every later message would be an
        // orphan.
        writer.flush()?;
        Ok(writer)
    }

    /// Declares a topic while the recording runs, and writes that down at once.
    ///
    /// # Errors
    /// If the topic is known with another type, schema or QoS, or the file cannot be written.
    pub fn add_topic(&mut self, topic: &TopicSpec) -> Result<(), WriteError> {
        self.declare(topic)?;
        self.flush()
    }

    fn declare(&mut self, topic: &TopicSpec) -> Result<(), WriteError> {
        if let Some(known) = self.topics.get(&topic.name) {
            let same = known.spec == *topic;
            return if same { Ok(()) } else { Err(WriteError::ConflictingTopic(topic.name.clone())) };
        }
        let channel = self.with("declare a topic", |mcap| {
            let schema = mcap.add_schema(&topic.ros_type, "ros2msg", topic.definition.as_bytes())?;
            let metadata = BTreeMap::from([
                ("offered_qos_profiles".to_owned(), topic.qos.clone()),
                ("topic_type_hash".to_owned(), topic.type_hash.clone()),
            ]);
            mcap.add_channel(schema, &topic.name, "cdr", &metadata)
        })?;
        self.ledger.expect(&topic.name);
        self.topics.insert(topic.name.clone(), Channel { spec: topic.clone(), channel, messages: 0 });
        Ok(())
    }

    /// Records a sample. Its log time is the time of arrival, moved forward as far as it takes to be later
    /// than the last one and not earlier than the source time's own; its `sequence` is the low half of the
    /// RTPS sequence number.
    ///
    /// # Errors
    /// If the topic was not declared, the sample is no CDR, or the recording has ended (disk full, write
    /// failure).
    pub fn write(&mut self, topic: &str, sample: &Incoming<'_>) -> Result<Outcome, WriteError> {
        let Some(channel_id) = self.topics.get(topic).map(|t| t.channel) else {
            return Err(WriteError::UnknownTopic(topic.to_owned()));
        };
        if sample.payload.len() < 4 {
            let (topic, sequence) = (topic.to_owned(), sample.sequence);
            return Err(WriteError::NotCdr { topic, sequence, bytes: sample.payload.len() });
        }
        if self.ledger.holds(topic, &sample.guid, sample.sequence) {
            self.ledger.enter(topic, sample.guid, sample.sequence);
            return Ok(Outcome::Repeated);
        }
        let log_time = self.bounds.map_or(sample.receive_time, |(_, last)| sample.receive_time.max(last + 1));
        let publish_time = sample.source_time.unwrap_or(log_time).min(log_time);
        let header = MessageHeader { channel_id, sequence: sample.sequence as u32, log_time, publish_time };
        self.with("write a message", |mcap| mcap.write_to_known_channel(&header, sample.payload))?;
        self.ledger.enter(topic, sample.guid, sample.sequence);
        if let Some(t) = self.topics.get_mut(topic) {
            t.messages += 1;
        }
        self.bounds = Some((self.bounds.map_or(log_time, |(first, _)| first), log_time));
        let now = Instant::now();
        self.pending.get_or_insert(now);
        self.unchecked += sample.payload.len() as u64;
        if self.unchecked >= CHECK_EVERY {
            self.require_space()?;
        }
        self.tick(now)?;
        Ok(Outcome::Recorded { log_time })
    }

    /// Hands the open chunk to the system if its oldest message is older than the flush interval, and has the
    /// file pushed to the device from time to time. Cheap when there is nothing to do.
    ///
    /// # Errors
    /// If the file cannot be written, or a push to the device failed.
    pub fn tick(&mut self, now: Instant) -> Result<(), WriteError> {
        if self
            .pending
            .is_some_and(|since| now.saturating_duration_since(since) >= self.options.flush_interval)
        {
            self.flush()?;
            self.require_space()?;
        }
        self.sync.request(now, self.options.sync_interval);
        match self.sync.failure() {
            Some(source) => {
                let error = WriteError::Io {
                    path: self.file.clone(),
                    action: "push the recording to the device",
                    source,
                };
                self.ended = Some(error.to_string());
                Err(error)
            }
            None => Ok(()),
        }
    }

    /// Stores a file in the recording (scene, launch file, parameters) and writes it down at once.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn attach(&mut self, name: &str, media_type: &str, bytes: &[u8]) -> Result<(), WriteError> {
        let time =
            SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.as_nanos() as u64);
        let attachment = Attachment {
            log_time: time,
            create_time: time,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: Cow::Borrowed(bytes),
        };
        self.with("attach a file", |mcap| mcap.attach(&attachment))?;
        self.flush()
    }

    /// Sets a key of the metadata record that [`RunWriter::finish`] writes.
    pub fn set_metadata(&mut self, key: &str, value: &str) {
        self.metadata.insert(key.to_owned(), value.to_owned());
    }

    /// The account so far.
    pub fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// The account, to enter reports and names of writers.
    pub fn ledger_mut(&mut self) -> &mut Ledger {
        &mut self.ledger
    }

    /// The file being written.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Writes the account, the indexes and `metadata.yaml`, and returns when all of it is on the device.
    /// After a disk that filled up this still works; after a write failure it says so, and what was written
    /// before stays readable.
    ///
    /// # Errors
    /// If the recording cannot be completed. It then has no `metadata.yaml`.
    pub fn finish(mut self) -> Result<Finished, WriteError> {
        self.close(true)
    }

    fn close(&mut self, finished: bool) -> Result<Finished, WriteError> {
        let Some(mut mcap) = self.mcap.take() else {
            return Err(self.already_ended());
        };
        let path = self.file.clone();
        let format = |action: &'static str| {
            let path = path.clone();
            move |source| WriteError::mcap(&path, action, source)
        };
        let mut metadata = std::mem::take(&mut self.metadata);
        metadata.insert("finished".into(), finished.to_string());
        if let Some(reason) = &self.ended {
            metadata.insert("ended_by".into(), reason.clone());
        }
        let tallies = serde_json::to_string(&self.ledger.tallies()).map_err(|e| WriteError::Io {
            path: path.clone(),
            action: "express the account",
            source: e.into(),
        })?;
        metadata.insert(LEDGER_KEY.into(), tallies);
        if let Err(source) = mcap.write_metadata(&Metadata { name: METADATA_RECORD.into(), metadata }) {
            // After a failed write the MCAP writer only says that it failed; the reason is the first error.
            return Err(if self.ended.is_some() {
                self.already_ended()
            } else {
                format("write the account")(source)
            });
        }
        mcap.finish().map_err(format("write the index"))?;
        let io = |action: &'static str| {
            let path = path.clone();
            move |source| WriteError::Io { path, action, source }
        };
        let handle =
            mcap.into_inner().into_inner().map_err(|e| io("write the end of the file")(e.into_error()))?;
        self.sync.stop();
        handle.sync_all().map_err(io("push the recording to the device"))?;
        let bytes = handle.metadata().map_err(io("ask for the size"))?.len();
        let (start, end) = self.bounds.unwrap_or((0, 0));
        let messages = self.topics.values().map(|t| t.messages).sum();
        let bag = BagMetadata {
            file: &self.file,
            start,
            duration: end - start,
            messages,
            topics: self
                .topics
                .values()
                .map(|t| TopicCount { spec: &t.spec, messages: t.messages })
                .collect(),
        };
        bag.write(&self.directory).map_err(io("write metadata.yaml beside it"))?;
        Ok(Finished {
            file: self.file.clone(),
            bytes,
            messages,
            start,
            end,
            ledger: std::mem::take(&mut self.ledger),
        })
    }

    fn flush(&mut self) -> Result<(), WriteError> {
        self.with("write a chunk", |mcap| mcap.flush())?;
        self.pending = None;
        self.sync.note_written();
        Ok(())
    }

    fn require_space(&mut self) -> Result<(), WriteError> {
        self.unchecked = 0;
        let free = free_space(&self.directory).map_err(|source| WriteError::Io {
            path: self.directory.clone(),
            action: "ask for free space",
            source,
        })?;
        if free >= self.options.free_to_continue {
            return Ok(());
        }
        let error = WriteError::NoSpace {
            path: self.file.clone(),
            free,
            needed: self.options.free_to_continue,
            state: "stopped (what is recorded stays readable)",
        };
        self.ended = Some(error.to_string());
        Err(error)
    }

    /// Runs `action` on the MCAP writer unless the recording has ended; a failure ends it.
    fn with<T>(
        &mut self,
        what: &'static str,
        action: impl FnOnce(&mut mcap::Writer<BufWriter<File>>) -> Result<T, McapError>,
    ) -> Result<T, WriteError> {
        let Some(mcap) = self.mcap.as_mut().filter(|_| self.ended.is_none()) else {
            return Err(self.already_ended());
        };
        action(mcap).map_err(|source| {
            let error = WriteError::mcap(&self.file, what, source);
            self.ended = Some(error.to_string());
            error
        })
    }

    fn already_ended(&self) -> WriteError {
        let reason = self.ended.clone().unwrap_or_else(|| "it was finished".into());
        WriteError::Ended { path: self.file.clone(), reason }
    }
}

impl Drop for RunWriter {
    fn drop(&mut self) {
        // No caller is left to take an error: the missing end of the file and of metadata.yaml tell it to
        // every reader.
        if self.mcap.is_some() {
            let _ = self.close(false);
        }
    }
}
