//! One process at a time in a directory.

use crate::host::host_name;
use grainlab_console::Failure;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::Path;
use std::time::{Duration, Instant};

/// Period of the attempts.
const POLL_PERIOD: Duration = Duration::from_millis(50);

/// The lock of a directory, which ends with the process that holds it, however that ends.
#[derive(Debug)]
pub struct Lock {
    file: File,
}

/// The process at work in a directory, as `process 12 on HOST`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AtWork {
    /// None is at work: the last one ended, or was killed.
    Nobody,
    /// This one holds the lock.
    Holder(String),
    /// This one of another host left no end, and locks need not be seen from host to host.
    Elsewhere(String),
}

impl Lock {
    /// Name of the file.
    pub const FILE: &str = ".lock";

    /// Locks an existing directory. The previous holder has `patience` to end.
    pub fn take(directory: &Path, patience: Duration) -> Result<Self, Failure> {
        let path = directory.join(Self::FILE);
        let failed = |e: &dyn std::fmt::Display| Failure::failed(format!("{}: {e}", path.display()));
        let mut file = OpenOptions::new().create(true).append(true).open(&path).map_err(|e| failed(&e))?;
        let until = Instant::now() + patience;
        let mut told = patience.is_zero();
        loop {
            match file.try_lock() {
                Ok(()) => {
                    // A full disk does not keep the lock from holding.
                    let _ = file.set_len(0);
                    let _ = file.write_all(holder(&host_name()).as_bytes());
                    return Ok(Self { file });
                }
                Err(TryLockError::WouldBlock) => {
                    let who = std::fs::read_to_string(&path).unwrap_or_default();
                    let who = if who.is_empty() { "another process" } else { &who };
                    let at_work = format!("{who} is at work in this directory");
                    if Instant::now() >= until {
                        return Err(failed(&format!("{at_work}: wait for it, or end it")));
                    }
                    if !std::mem::replace(&mut told, true) {
                        let (path, s) = (path.display(), patience.as_secs());
                        grainlab_console::say!(
                            "grainlab: {path}: {at_work}: waiting at most {s} s for its end"
                        );
                    }
                    std::thread::sleep(POLL_PERIOD);
                }
                Err(TryLockError::Error(error)) => return Err(failed(&error)),
            }
        }
    }

    /// The process at work in a directory.
    pub fn at_work(directory: &Path) -> AtWork {
        let path = directory.join(Self::FILE);
        let Ok(file) = File::open(&path) else { return AtWork::Nobody };
        let held = file.try_lock_shared();
        let who = std::fs::read_to_string(&path).unwrap_or_default();
        match held {
            Err(TryLockError::WouldBlock) => AtWork::Holder(who),
            Ok(()) if who.is_empty() || who.ends_with(&format!(" on {}", host_name())) => AtWork::Nobody,
            _ => AtWork::Elsewhere(who),
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        let _ = self.file.set_len(0);
    }
}

fn holder(host: &str) -> String {
    format!("process {} on {host}", std::process::id())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_directory_has_one_holder_and_is_free_after_it() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(Lock::at_work(folder.path()), AtWork::Nobody);
        let first = Lock::take(folder.path(), Duration::ZERO).unwrap();
        let second = Lock::take(folder.path(), 2 * POLL_PERIOD).unwrap_err().to_string();
        let me = holder(&host_name());
        assert!(second.contains(&format!("{me} is at work")), "{second}");
        assert_eq!(Lock::at_work(folder.path()), AtWork::Holder(me));
        drop(first);
        let left = |text: &str| std::fs::write(folder.path().join(Lock::FILE), text).unwrap();
        left(&holder(&host_name()));
        assert_eq!(Lock::at_work(folder.path()), AtWork::Nobody, "it was killed");
        left(&holder("node7"));
        assert_eq!(Lock::at_work(folder.path()), AtWork::Elsewhere(holder("node7")));
        drop(Lock::take(folder.path(), Duration::ZERO).unwrap());
        assert_eq!(Lock::at_work(folder.path()), AtWork::Nobody);
    }
}
