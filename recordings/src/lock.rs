//! One process at a time in a directory.

use grainlab_console::Failure;
use std::fs::{File, OpenOptions, TryLockError};
use std::path::Path;
use std::time::{Duration, Instant};

/// Period of the attempts.
const POLL_PERIOD: Duration = Duration::from_millis(50);

/// The lock of a directory, which ends with the process that holds it, however that ends.
#[derive(Debug)]
pub struct Lock {
    _file: File,
}

impl Lock {
    /// Name of the file.
    pub const FILE: &str = ".lock";

    /// Locks an existing directory. The previous holder has `patience` to end.
    pub fn take(directory: &Path, patience: Duration) -> Result<Self, Failure> {
        let path = directory.join(Self::FILE);
        let failed = |e: &dyn std::fmt::Display| Failure::failed(format!("{}: {e}", path.display()));
        let file = OpenOptions::new().create(true).append(true).open(&path).map_err(|e| failed(&e))?;
        let until = Instant::now() + patience;
        loop {
            match file.try_lock() {
                Ok(()) => return Ok(Self { _file: file }),
                Err(TryLockError::WouldBlock) if Instant::now() < until => std::thread::sleep(POLL_PERIOD),
                Err(TryLockError::WouldBlock) => {
                    return Err(failed(
                        &"another process is at work in this directory: wait for it, or end it",
                    ));
                }
                Err(TryLockError::Error(error)) => return Err(failed(&error)),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_directory_has_one_holder_and_is_free_after_it() {
        let folder = tempfile::tempdir().unwrap();
        let first = Lock::take(folder.path(), Duration::ZERO).unwrap();
        let second = Lock::take(folder.path(), 2 * POLL_PERIOD).unwrap_err().to_string();
        assert!(second.contains("another process"), "{second}");
        drop(first);
        Lock::take(folder.path(), Duration::ZERO).unwrap();
    }
}
