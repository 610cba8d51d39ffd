//! The files of a run: their names, and whether a recorder is writing them.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::failures::cannot;
use grainlab_console::Failure;

/// Part `number` of the recording `name`.
pub(super) fn part_path(directory: &Path, name: &str, number: u64) -> PathBuf {
    directory.join(format!("{name}_{number}.mcap"))
}

/// The number after those of all existing parts.
pub(super) fn next_number(directory: &Path, name: &str) -> Result<u64, Failure> {
    let io = |source: std::io::Error| cannot(directory, "read the directory")(source);
    let mut next = 0;
    if !directory.exists() {
        return Ok(next);
    }
    for entry in fs::read_dir(directory).map_err(io)? {
        let path = entry.map_err(io)?.path();
        let text = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let part = text.strip_prefix(name).and_then(|t| t.strip_prefix('_'));
        let part = part.and_then(|t| t.strip_suffix(".mcap")).and_then(|n| n.parse::<u64>().ok());
        let Some(part) = part else { continue };
        if File::open(&path).is_ok_and(|f| is_locked(&f)) {
            let path = path.display();
            return Err(Failure::failed(format!("{path} is being recorded: end that recorder first")));
        }
        next = next.max(part.saturating_add(1));
    }
    Ok(next)
}

/// True if a recorder has locked the file; false on a file system without locks.
pub(crate) fn is_locked(file: &File) -> bool {
    matches!(file.try_lock_shared(), Err(fs::TryLockError::WouldBlock))
}

/// The session of this writer, unique within its directory: its start, ns since 1970.
pub(super) fn session() -> String {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.as_nanos()).to_string()
}
