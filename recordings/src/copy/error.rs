//! Errors of a copy. Nothing was written under the name of the output.

use std::io;
use std::path::{Path, PathBuf};

use mcap::McapError;

/// Why a copy was not made.
#[derive(Debug, thiserror::Error)]
pub enum CopyError {
    /// The output exists.
    #[error("{path} exists: choose another output; nothing is overwritten")]
    Exists {
        /// Path of the output.
        path: PathBuf,
    },
    /// Two recordings have different messages under one topic.
    #[error(
        "{topic} is {first_type} in {first} and {second_type}, with other fields, in {second}: readers such as rosbags take one \
         definition for a type and would misread the other messages. Leave the topic out with --exclude, or merge the recordings \
         that agree"
    )]
    Clash {
        /// Name of the topic.
        topic: String,
        /// A recording and its type of the topic.
        first: PathBuf,
        /// Type of its messages.
        first_type: String,
        /// Path of another recording.
        second: PathBuf,
        /// Type of its messages.
        second_type: String,
    },
    /// Pictures of packings are wanted, and there are no packings.
    #[error("there is no topic of type grainlab_msgs/msg/Packing of which pictures could be made")]
    NoPackings,
    /// Pictures of packings are wanted, and there is a topic of their name.
    #[error("there is a topic {topic} already: leave it out with --exclude {topic}")]
    Pictured {
        /// Name of the topic.
        topic: String,
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
    #[error("{path}: cannot {action}: {source}")]
    Format {
        /// Path of the output.
        path: PathBuf,
        /// The attempted action.
        action: &'static str,
        /// Error that was returned.
        source: McapError,
    },
}

impl CopyError {
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
