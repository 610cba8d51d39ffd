//! Options of a recording.

use std::time::Duration;

use crate::compression::Compression;

/// Options of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WriterOptions {
    /// Compression of the chunks.
    pub compression: Compression,
    /// Uncompressed bytes after which a chunk is closed.
    pub chunk_size: u64,
    /// Age of the oldest message at which an open chunk is closed and written. The sum of this and of the
    /// interval between calls of [`RunWriter::tick`](super::RunWriter::tick) is what a crash may lose.
    pub flush_interval: Duration,
    /// Time between two syncs to the device.
    pub sync_interval: Duration,
    /// Bytes of a file after which the next one is begun: a file exceeds it by at most one chunk, and its index.
    pub split_bytes: u64,
    /// Age of a file at which the next one is begun: its index grows in memory by some 6 MB per hour.
    pub split_after: Duration,
    /// Bytes that must be free to begin.
    pub free_to_start: u64,
    /// Bytes that must stay free: below, the recording is completed while this is still possible.
    pub free_to_continue: u64,
}

impl Default for WriterOptions {
    fn default() -> Self {
        Self {
            compression: Compression::default(),
            chunk_size: 768 << 10,
            flush_interval: Duration::from_millis(400),
            sync_interval: Duration::from_secs(1),
            split_bytes: 512 << 20,
            split_after: Duration::from_secs(15 * 60),
            free_to_start: 64 << 20,
            free_to_continue: 32 << 20,
        }
    }
}
