//! The files of a run: their names, and whether a recorder is writing them.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::failures::cannot;
use grainlab_console::{Failure, input};

pub(super) fn part_path(directory: &Path, name: &str, number: u64) -> PathBuf {
    directory.join(format!("{name}_{number}.mcap"))
}

/// Returns a file in this directory that belongs to a recording: an MCAP file with content, or one that is being written, or a
/// `metadata.yaml`. A directory that does not exist has none.
///
/// # Errors
/// Returns an error if the directory cannot be read.
pub fn recording_in(directory: &Path) -> Result<Option<PathBuf>, Failure> {
    if !directory.exists() {
        return Ok(None);
    }
    let entries = fs::read_dir(directory).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let paths = entries.map_err(cannot(directory, "read the directory"))?;
    let is_of_recording = |path: &PathBuf| {
        let is_mcap = path.extension().is_some_and(|e| e == "mcap");
        path.file_name().is_some_and(|name| name == "metadata.yaml") || (is_mcap && !is_abandoned(path))
    };
    Ok(paths.into_iter().map(|entry| entry.path()).filter(is_of_recording).min())
}

/// Refuses a directory with a recording, whose `metadata.yaml` a new one would replace.
pub(super) fn refuse_recording(directory: &Path) -> Result<(), Failure> {
    let Some(file) = recording_in(directory)? else { return Ok(()) };
    Err(Failure::usage(format!(
        "{} exists: choose another directory for the new recording; a recording is never overwritten, and a directory has one",
        file.display()
    )))
}

/// Returns the number after all existing parts, or after the parts with content if the others `are_replaced`.
pub(super) fn next_number(directory: &Path, name: &str, are_replaced: bool) -> Result<u64, Failure> {
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
        let Some(part) = part.filter(|_| !(are_replaced && is_abandoned(&path))) else { continue };
        if input::open(&path).is_ok_and(|(file, _)| is_locked(&file)) {
            let path = path.display();
            return Err(Failure::failed(format!("{path} is being recorded: end that recorder first")));
        }
        next = next.max(part.saturating_add(1));
    }
    Ok(next)
}

/// Returns true for a regular file without a byte that no recorder is writing: a power cut, or a full disk, left it.
pub(super) fn is_abandoned(path: &Path) -> bool {
    let is_empty = path.symlink_metadata().is_ok_and(|found| found.is_file() && found.len() == 0);
    is_empty && input::open(path).is_ok_and(|(file, _)| !is_locked(&file))
}

/// True if a recorder has locked the file; false on a file system without locks.
pub(crate) fn is_locked(file: &File) -> bool {
    matches!(file.try_lock_shared(), Err(fs::TryLockError::WouldBlock))
}

/// The session of this writer, unique within its directory: its start, ns since 1970 or before it.
pub(super) fn session() -> String {
    let start = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    start.unwrap_or_else(|before| before.duration()).as_nanos().to_string()
}
