//! What is wrong with a recording: errors that leave nothing to read, and warnings that name what is missing.

use std::fmt;
use std::io;
use std::path::PathBuf;

use serde::Serialize;

/// Why there is nothing to read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The path cannot be read.
    #[error("{path}: {source}")]
    Io {
        /// The path.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A directory without a recording.
    #[error("{path} holds no .mcap file: name a run directory or an MCAP file")]
    Empty {
        /// The directory.
        path: PathBuf,
    },
    /// Not an MCAP file.
    #[error("{path} is not an MCAP file: it has {bytes} bytes and does not start with the MCAP magic")]
    NotMcap {
        /// The file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// A topic that the recording does not have.
    #[error("{path} has no topic {topic}; it has: {known}")]
    NoSuchTopic {
        /// The recording.
        path: PathBuf,
        /// The topic asked for.
        topic: String,
        /// The topics there are.
        known: String,
    },
}

/// Something that could not be read, or contradicts something else; the rest of the recording is used.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Warning {
    /// The file.
    pub path: PathBuf,
    /// Byte of the file at which the trouble starts.
    pub offset: u64,
    /// What it is.
    pub kind: WarningKind,
    /// What was found there.
    pub detail: String,
}

/// Kinds of [`Warning`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum WarningKind {
    /// The recording was cut off here: the recorder was killed or is still at work.
    Truncated,
    /// The messages are all there, but the index is damaged or missing and was rebuilt.
    NoIndex,
    /// A chunk is damaged and was left out.
    DamagedChunk,
    /// A record other than a chunk is damaged and was left out.
    DamagedRecord,
    /// Messages whose channel was lost were left out.
    Orphans,
    /// A file that `metadata.yaml` names is missing.
    MissingFile,
    /// A file that `metadata.yaml` does not name belongs to the recording.
    Unlisted,
    /// The index contradicts the messages, or the checksum of the whole file fails.
    Inconsistent,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (path, at, detail) = (self.path.display(), self.offset, &self.detail);
        match self.kind {
            WarningKind::Truncated => {
                write!(f, "{path} is truncated: {detail}; what stands before byte {at} is used")
            }
            WarningKind::NoIndex => write!(f, "{path}: the index is damaged ({detail}); it was rebuilt"),
            WarningKind::DamagedChunk => write!(f, "{path}: the chunk at byte {at} is left out: {detail}"),
            WarningKind::DamagedRecord => write!(f, "{path}: the record at byte {at} is left out: {detail}"),
            WarningKind::Orphans => write!(f, "{path}: in the chunk at byte {at}, {detail}"),
            WarningKind::MissingFile => write!(f, "{path} is missing: {detail}"),
            WarningKind::Unlisted => write!(f, "{path} is read, too: {detail}"),
            WarningKind::Inconsistent => write!(f, "{path}, byte {at}: {detail}"),
        }
    }
}
