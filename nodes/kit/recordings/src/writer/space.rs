//! Space on the disk: how much is free, and space that is reserved ahead of what is written, so that a disk that others fill leaves
//! room for the end of a recording.

use std::fs::File;
use std::io;
use std::path::Path;

use rustix::fs::{FallocateFlags, fallocate};
use rustix::io::{Errno, retry_on_intr};

/// Bytes for the end of a file: its ledger and its index.
const END: u64 = 4 << 20;

/// Bytes that are reserved at a time.
const STEP: u64 = 4 << 20;

/// The reserved space of one file, which lies behind its end.
pub(super) struct Reserve {
    file: File,
    /// Offset up to which the file system has given space to the file.
    end: u64,
}

impl Reserve {
    pub(super) fn new(file: File) -> Self {
        Self { file, end: 0 }
    }

    /// Ensures that the file can grow to `size` and be completed then. A file system that reserves nothing gives no error.
    pub(super) fn ensure(&mut self, size: u64) -> io::Result<()> {
        let needed = size.saturating_add(END);
        if needed <= self.end {
            return Ok(());
        }
        let bytes = needed.saturating_add(STEP).saturating_sub(self.end);
        match retry_on_intr(|| fallocate(&self.file, FallocateFlags::KEEP_SIZE, self.end, bytes)) {
            Ok(()) => self.end += bytes,
            Err(full @ (Errno::NOSPC | Errno::DQUOT)) => return Err(full.into()),
            // NFS before 4.2 and FUSE, for example.
            Err(_) => self.end = u64::MAX,
        }
        Ok(())
    }
}

impl Drop for Reserve {
    /// Returns the space behind the end of the file to the file system.
    fn drop(&mut self) {
        // Space that stays reserved is no fault of the recording.
        let _ = self.file.metadata().and_then(|file| self.file.set_len(file.len()));
    }
}

/// Free bytes for an ordinary user on the file system of `path`.
pub(super) fn free_space(path: &Path) -> io::Result<u64> {
    let answer = rustix::fs::statvfs(path)?;
    Ok(answer.f_bavail.saturating_mul(answer.f_frsize))
}
