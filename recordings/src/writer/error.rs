//! Errors of a recording.

use std::io;
use std::path::{Path, PathBuf};

use mcap::McapError;

/// Errors at the start, during, or at the end of a recording.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// A recording exists already.
    #[error("{path} exists: choose another run directory; a recording is never overwritten")]
    Exists {
        /// The existing file.
        path: PathBuf,
    },
    /// Another recorder is writing the run.
    #[error("{path} is being recorded: end that recorder first")]
    InUse {
        /// The file it writes.
        path: PathBuf,
    },
    /// Not enough space to begin or to continue.
    #[error(
        "{path}: only {free} bytes are free on this file system and {needed} are needed; the recording was {state}: free space and run again"
    )]
    NoSpace {
        /// Path of the recording.
        path: PathBuf,
        /// Number of free bytes.
        free: u64,
        /// Bytes that must be free.
        needed: u64,
        /// `not begun`, or `stopped (what is recorded stays readable)`.
        state: &'static str,
    },
    /// The file system returned an error.
    #[error("{path}: cannot {action}: {source}")]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// The attempted action.
        action: &'static str,
        /// Error that was returned.
        source: io::Error,
    },
    /// The MCAP writer returned an error.
    #[error("{path}: cannot {action}: {source}; what was written before stays readable")]
    Format {
        /// Path of the recording.
        path: PathBuf,
        /// The attempted action.
        action: &'static str,
        /// Error that was returned.
        source: McapError,
    },
    /// The topic of a sample was never declared.
    #[error("topic {0} was not declared to the recording: add it with its type before its first message")]
    UnknownTopic(String),
    /// A topic was declared twice, differently.
    #[error("topic {0} is already recorded with another type, schema or QoS")]
    ConflictingTopic(String),
    /// A sample is too short to be CDR.
    #[error("message {sequence} on {topic} has {bytes} bytes: CDR starts with a 4-byte encapsulation header")]
    NotCdr {
        /// Topic of the message.
        topic: String,
        /// RTPS sequence number of the message.
        sequence: i64,
        /// Length of the payload, bytes.
        bytes: usize,
    },
    /// An earlier failure ended the recording.
    #[error("{path}: an earlier error ended this recording: {reason}")]
    Ended {
        /// Path of the recording.
        path: PathBuf,
        /// The earlier error.
        reason: String,
    },
}

impl WriteError {
    /// An error of the file system during `action`.
    pub(super) fn io(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::Io { path, action, source }
    }

    /// The error of the file system, if it was one.
    pub(super) fn mcap(path: &Path, action: &'static str, source: McapError) -> Self {
        let path = path.to_owned();
        match source {
            McapError::Io(source) => Self::Io { path, action, source },
            source => Self::Format { path, action, source },
        }
    }
}
