//! One MCAP file being written.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, ErrorKind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, Compression, McapError, WriteOptions};

use super::counted::Counted;
use super::device_sync::DeviceSync;
use super::names::is_abandoned;
use super::space::Reserve;
use super::{TopicSpec, WriterOptions};
use crate::failures::{cannot, reason};
use crate::reader::FileCount;
use grainlab_console::Failure;

type Writer = mcap::Writer<Counted<BufWriter<File>>>;

pub(super) struct Part {
    path: PathBuf,
    mcap: Writer,
    pub(super) sync: DeviceSync,
    reserve: Reserve,
    /// Bound on the bytes that the open chunk writes when it is closed.
    chunk_bytes: u64,
    /// Bytes written so far.
    written: Arc<AtomicU64>,
    channels: BTreeMap<String, u16>,
    messages: u64,
    /// First and last log time.
    bounds: Option<(u64, u64)>,
    began: Instant,
}

pub(super) struct Closed {
    pub(super) path: PathBuf,
    pub(super) bytes: u64,
    pub(super) count: FileCount,
}

impl Part {
    /// Begins the file, which must not exist, or be empty and of no recorder. It stays locked while it is open, so that no process
    /// recovers a file being recorded.
    pub(super) fn create(path: PathBuf, of: &WriterOptions, began: Instant) -> Result<Self, Failure> {
        let io = |action| cannot::<io::Error>(&path, action);
        if is_abandoned(&path) {
            std::fs::remove_file(&path).map_err(io("replace the empty file"))?;
        }
        let file = match File::create_new(&path) {
            Err(e) if e.kind() == ErrorKind::AlreadyExists => {
                return Err(Failure::usage(format!(
                    "{} exists: choose another directory; a recording is never overwritten",
                    path.display()
                )));
            }
            other => other.map_err(io("create the file"))?,
        };
        // A file system without locks cannot report another recorder.
        let _ = file.try_lock();
        let duplicate = || file.try_clone().map_err(io("duplicate the handle"));
        let reserve = Reserve::new(duplicate()?);
        let sync =
            DeviceSync::start(duplicate()?).map_err(io("start the thread that syncs data to the device"))?;
        let counted = Counted::new(BufWriter::with_capacity(64 << 10, file));
        let written = counted.count();
        let mcap = options("")
            .compression(of.compression.of_chunks())
            .chunk_size(Some(of.chunk_size))
            .create(counted)
            .map_err(|e| cannot(&path, "write the header")(reason(e)))?;
        let channels = BTreeMap::new();
        // A chunk of short messages has an index of nearly its own size.
        let chunk_bytes = 2 * of.chunk_size;
        Ok(Self {
            path,
            mcap,
            sync,
            reserve,
            chunk_bytes,
            written,
            channels,
            messages: 0,
            bounds: None,
            began,
        })
    }

    /// Reserves space for `bytes`, the open chunk and the end of the file, which can still be completed after an error.
    pub(super) fn reserve(&mut self, bytes: usize) -> Result<(), McapError> {
        let size = self.bytes().saturating_add(self.chunk_bytes).saturating_add(bytes as u64);
        self.reserve.ensure(size).map_err(McapError::Io)
    }

    pub(super) fn began(&self) -> Instant {
        self.began
    }

    pub(super) fn has_messages(&self) -> bool {
        self.bounds.is_some()
    }

    /// Size of the file with all chunks that are complete, bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.written.load(Ordering::Relaxed)
    }

    pub(super) fn declare(&mut self, topic: &TopicSpec) -> Result<(), McapError> {
        let schema =
            self.mcap.add_schema(&topic.ros_type, &topic.schema_encoding, topic.definition.as_bytes())?;
        let metadata = BTreeMap::from([
            ("offered_qos_profiles".to_owned(), topic.qos.clone()),
            ("topic_type_hash".to_owned(), topic.type_hash.clone()),
        ]);
        let channel = self.mcap.add_channel(schema, &topic.name, "cdr", &metadata)?;
        self.channels.insert(topic.name.clone(), channel);
        Ok(())
    }

    pub(super) fn write(
        &mut self,
        topic: &str,
        sequence: u32,
        log_time: u64,
        publish_time: u64,
        payload: &[u8],
    ) -> Result<(), McapError> {
        // Topics are declared in every part before any message is written.
        let channel_id = self.channels.get(topic).copied().unwrap_or(0);
        let header = MessageHeader { channel_id, sequence, log_time, publish_time };
        self.mcap.write_to_known_channel(&header, payload)?;
        self.messages += 1;
        self.bounds = Some((self.bounds.map_or(log_time, |(first, _)| first), log_time));
        Ok(())
    }

    pub(super) fn attach(&mut self, attachment: &Attachment<'_>) -> Result<(), McapError> {
        self.mcap.attach(attachment)
    }

    pub(super) fn flush(&mut self) -> Result<(), McapError> {
        self.mcap.flush()?;
        self.sync.note_written();
        Ok(())
    }

    /// Writes the metadata record and the index, and syncs the file to the device.
    pub(super) fn close(mut self, metadata: Metadata) -> Result<Closed, Failure> {
        let path = self.path.clone();
        let io = |action| cannot::<io::Error>(&path, action);
        self.mcap.write_metadata(&metadata).map_err(|e| cannot(&path, "write the ledger")(reason(e)))?;
        self.mcap.finish().map_err(|e| cannot(&path, "write the index")(reason(e)))?;
        let handle = self
            .mcap
            .into_inner()
            .into_inner()
            .into_inner()
            .map_err(|e| io("write the end of the file")(e.into_error()))?;
        self.sync.stop();
        handle.sync_all().map_err(io("sync the recording to the device"))?;
        let bytes = handle.metadata().map_err(io("query the size"))?.len();
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let count = FileCount { name, bounds: self.bounds, messages: self.messages };
        Ok(Closed { path, bytes, count })
    }
}

/// Chunks are written whole with their final header (`disable_seeking`), so a crash leaves a valid prefix.
pub(crate) fn options(remark: &str) -> WriteOptions {
    WriteOptions::new()
        .profile("ros2")
        .library(format!("grainlab {}{remark}", env!("CARGO_PKG_VERSION")))
        .compression(Some(Compression::Zstd))
        .compression_level(1)
        .compression_threads(0)
        .disable_seeking(true)
}
