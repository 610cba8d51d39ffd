//! The amount of a recording in memory.

use memmap2::Mmap;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};

/// Contents of chunks that may be in memory at once for a recording of any size, bytes.
const LEAST: u64 = 1 << 30;

/// Above [`LEAST`], bytes in memory per byte of the recording.
const RATIO: u64 = 64;

/// Counts the contents in memory whose messages are still in use or to be returned. Chunks of real recordings
/// follow each other in time and have moderate compression; only forged ones exceed the limit.
pub(super) struct Held {
    memory: Arc<Memory>,
    most: u64,
}

#[derive(Default)]
pub(super) struct Memory {
    in_use: AtomicU64,
    /// No longer in use: the next content takes it, which saves the system from clearing new memory for every chunk.
    spare: Mutex<Vec<Vec<u8>>>,
}

/// Spare memory that is kept: so many contents, each at most so large, bytes.
const SPARE: usize = 2;
const LARGEST_SPARE: usize = 8 << 20;

pub(super) enum Content {
    /// Content that was decompressed.
    Own { bytes: Vec<u8>, memory: Arc<Memory> },
    /// A part of the file, which needs no memory of its own.
    Part { file: Arc<Mmap>, range: Range<usize> },
}

impl Held {
    /// For a recording of this size, bytes.
    pub(super) fn new(size: u64) -> Self {
        Self::up_to(size.saturating_mul(RATIO).max(LEAST))
    }

    pub(super) fn up_to(most: u64) -> Self {
        Self { memory: Arc::default(), most }
    }

    pub(super) fn is_full(&self) -> bool {
        self.memory.in_use.load(Relaxed) >= self.most
    }

    pub(super) fn content(&self, bytes: Vec<u8>) -> Content {
        self.memory.in_use.fetch_add(bytes.len() as u64, Relaxed);
        Content::Own { bytes, memory: Arc::clone(&self.memory) }
    }

    /// Memory for the next content; what is in it is of no use.
    pub(super) fn spare(&self) -> Vec<u8> {
        self.memory.spare.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default()
    }
}

impl Content {
    pub(super) fn bytes(&self) -> &[u8] {
        match self {
            Self::Own { bytes, .. } => bytes,
            Self::Part { file, range } => &file[range.clone()],
        }
    }
}

impl Drop for Content {
    fn drop(&mut self) {
        if let Self::Own { bytes, memory } = self {
            memory.in_use.fetch_sub(bytes.len() as u64, Relaxed);
            let mut spare = memory.spare.lock().unwrap_or_else(PoisonError::into_inner);
            if spare.len() < SPARE && bytes.capacity() <= LARGEST_SPARE {
                spare.push(std::mem::take(bytes));
            }
        }
    }
}
