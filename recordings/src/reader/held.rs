//! How much of a recording is in memory.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Content of chunks that may be in memory at once, whatever the size of the recording, bytes.
const LEAST: u64 = 256 << 20;

/// Beyond [`LEAST`], bytes in memory for each byte of the recording.
const RATIO: u64 = 64;

/// Counts the contents that are in memory because messages of theirs are still to be given, or in use. Chunks of
/// true recordings follow each other in time and compress some times; only forged ones need more than is allowed.
pub(super) struct Held {
    bytes: Arc<AtomicU64>,
    most: u64,
}

/// Content of a chunk; several messages share it.
pub(super) struct Content {
    bytes: Vec<u8>,
    held: Arc<AtomicU64>,
}

impl Held {
    /// For a recording of this size, bytes.
    pub(super) fn new(size: u64) -> Self {
        Self { bytes: Arc::default(), most: size.saturating_mul(RATIO).max(LEAST) }
    }

    pub(super) fn is_full(&self) -> bool {
        self.bytes.load(Relaxed) >= self.most
    }

    pub(super) fn content(&self, bytes: Vec<u8>) -> Content {
        self.bytes.fetch_add(bytes.len() as u64, Relaxed);
        Content { bytes, held: Arc::clone(&self.bytes) }
    }
}

impl Content {
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

impl Drop for Content {
    fn drop(&mut self) {
        self.held.fetch_sub(self.bytes.len() as u64, Relaxed);
    }
}
