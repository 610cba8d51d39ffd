//! Errors that leave nothing to read, and warnings about missing parts.

use std::fmt;
use std::path::{Path, PathBuf};

use grainlab_console::Failure;
use serde::{Deserialize, Serialize};

pub(super) fn not_mcap(path: &Path, bytes: &[u8]) -> Failure {
    let advice = "write it again with `ros2 bag convert`";
    let why = if bytes.starts_with(&[0x28, 0xb5, 0x2f, 0xfd]) {
        format!("it is compressed as a whole by Zstandard: unpack it (`zstd -d`), or {advice}")
    } else if bytes.starts_with(b"SQLite format 3") {
        format!("it is an SQLite database, the older format of rosbag2: {advice}")
    } else {
        format!("it has {} bytes and does not start with the MCAP magic", bytes.len())
    };
    Failure::failed(format!("{} is not an MCAP file: {why}", path.display()))
}

pub(super) fn empty(path: &Path) -> Failure {
    let advice = "give a run directory or an MCAP file";
    Failure::failed(format!("{} contains no .mcap file: {advice}", path.display()))
}

pub(crate) fn no_such_topic(path: &Path, topic: &str, known: &str) -> Failure {
    Failure::usage(format!("{} has no topic {topic}; it has: {known}", path.display()))
}

/// A part that could not be read, or that contradicts another; the rest of the recording is used.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Warning {
    /// Path of the file.
    pub path: PathBuf,
    /// Byte of the file at which the fault starts.
    pub offset: u64,
    /// Kind of the fault.
    pub kind: WarningKind,
    /// Description of the fault.
    pub detail: String,
}

impl Warning {
    pub(super) fn of_file(path: PathBuf, kind: WarningKind, detail: impl Into<String>) -> Self {
        Self { path, offset: 0, kind, detail: detail.into() }
    }
}

/// Kinds of [`Warning`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WarningKind {
    /// The recording is truncated here: the recorder was killed or is still running.
    Truncated,
    /// All messages are readable, but the index is wrong and was rebuilt.
    NoIndex,
    /// A chunk is damaged and was left out.
    DamagedChunk,
    /// A record other than a chunk is damaged and was left out.
    DamagedRecord,
    /// Messages whose channel was lost were left out.
    Orphans,
    /// A file listed in `metadata.yaml` is missing.
    MissingFile,
    /// A file not listed in `metadata.yaml` belongs to the recording.
    Unlisted,
    /// A file not listed in `metadata.yaml` is in the directory, with a name that no part of the recording has.
    Unread,
    /// The index contradicts the messages, or the checksum of the whole file fails.
    Inconsistent,
    /// Bytes follow the end of the recording in its file, and are not read.
    AfterEnd,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (path, at, detail) = (self.path.display(), self.offset, &self.detail);
        match self.kind {
            WarningKind::Truncated => {
                write!(f, "{path} is truncated: {detail}; the part before byte {at} is used")
            }
            WarningKind::NoIndex => {
                write!(f, "{path}: the index is wrong ({detail}): it was rebuilt from the records")
            }
            WarningKind::DamagedChunk => write!(f, "{path}: the chunk at byte {at} is left out: {detail}"),
            WarningKind::DamagedRecord => write!(f, "{path}: the record at byte {at} is left out: {detail}"),
            WarningKind::Orphans => write!(f, "{path}: in the chunk at byte {at}, {detail}"),
            WarningKind::MissingFile => write!(f, "{path} is missing: {detail}"),
            WarningKind::Unlisted => write!(f, "{path} is read, too: {detail}"),
            WarningKind::Unread => write!(f, "{path} is not read: {detail}"),
            WarningKind::Inconsistent | WarningKind::AfterEnd => write!(f, "{path}, byte {at}: {detail}"),
        }
    }
}
