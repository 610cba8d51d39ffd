//! The amount of a recording in memory.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Contents of chunks that may be in memory at once for a recording of any size, bytes.
const LEAST: u64 = 256 << 20;

/// Above [`LEAST`], bytes in memory per byte of the recording.
const RATIO: u64 = 64;

/// Counts the contents in memory whose messages are still in use or to be returned. Chunks of real recordings
/// follow each other in time and have moderate compression; only forged ones exceed the limit.
pub(super) struct Held {
    bytes: Arc<AtomicU64>,
    most: u64,
}

/// Content of a chunk, shared by several messages.
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
