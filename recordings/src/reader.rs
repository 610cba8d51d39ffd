//! Recordings: one MCAP file or a run directory, read by topic and time.
//!
//! A complete file is read through its index. A file that was cut off, or whose index is damaged, is read
//! from its start as far as it goes. A chunk whose checksum fails is left out. Whatever could not be read is
//! named by [`Recording::warnings`]; bytes never make it panic.
//!
//! Memory is bounded: a chunk may decompress to 64 times its size, or 64 MiB where that is more, and never to more than
//! 1 GiB; all that is in memory at once, to 64 times the recording's size, or 256 MiB, and one chunk more.
//!
//! The file is mapped into memory: it must not be shortened by somebody else meanwhile (growing is fine).

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

mod chunk;
mod error;
mod file;
mod files;
mod held;
mod index;
mod info;
mod lengths;
mod messages;
mod records;
mod verify;
pub(crate) mod walk;

pub use error::{ReadError, Warning, WarningKind};
pub use info::{Info, TopicInfo};
pub use messages::{Message, Messages, Payload};
pub use verify::Check;

use crate::bag_metadata::FileCount;
use crate::ledger::{self, TopicTally};
use crate::{LEDGER_KEY, METADATA_RECORD, SESSION_KEY};
use file::OpenFile;

/// What a recording says about one topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelInfo {
    /// Absolute name, `/stress`.
    pub topic: String,
    /// Type, `grainlab_msgs/msg/Stress`; empty if the channel has no schema.
    pub ros_type: String,
    /// Schema text; `ros2msg` in recordings of ROS 2.
    pub definition: String,
    /// Encoding of the schema.
    pub schema_encoding: String,
    /// Encoding of the messages; `cdr` in recordings of ROS 2.
    pub message_encoding: String,
    /// Offered QoS as the YAML list of rosbag2; empty if unknown.
    pub qos: String,
    /// `RIHS01_…`, or empty if unknown.
    pub type_hash: String,
}

impl ChannelInfo {
    /// Whether the recorded QoS is transient local: whoever joins late gets the last message.
    pub fn is_latched(&self) -> bool {
        // rosbag2 writes an integer up to version 8 of its metadata, a word from version 9 on.
        self.qos.lines().any(|line| {
            let mut parts = line.trim_start_matches(['-', ' ']).splitn(2, ':').map(str::trim);
            parts.next() == Some("durability") && matches!(parts.next(), Some("1" | "transient_local"))
        })
    }
}

/// Which messages are wanted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Names of topics, with or without the leading slash; `None` for all.
    pub topics: Option<Vec<String>>,
    /// First log time, ns since 1970.
    pub start: Option<u64>,
    /// Log time before which to end, ns since 1970.
    pub end: Option<u64>,
}

impl Selection {
    /// Everything on these topics.
    pub fn topics<S: Into<String>>(names: impl IntoIterator<Item = S>) -> Self {
        Self { topics: Some(names.into_iter().map(Into::into).collect()), ..Self::default() }
    }
}

/// A file stored in a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredFile {
    /// Its name.
    pub name: String,
    /// Its media type.
    pub media_type: String,
    /// When it was stored, ns since 1970.
    pub time: u64,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// An opened recording.
#[derive(Debug)]
pub struct Recording {
    path: PathBuf,
    files: Vec<OpenFile>,
    warnings: Mutex<BTreeSet<Warning>>,
}

impl Recording {
    /// Opens an MCAP file, or a run directory: the files that its `metadata.yaml` names, else all that it
    /// holds.
    ///
    /// # Errors
    /// If there is nothing, or what is there is not MCAP. A damaged recording is no error: see
    /// [`Recording::warnings`].
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let mut warnings = BTreeSet::new();
        let paths = files::of_recording(path, &mut warnings)?;
        let mut files = Vec::with_capacity(paths.len());
        for file in paths {
            files.push(OpenFile::map(&file, &mut warnings)?);
        }
        Ok(Self { path: path.to_owned(), files, warnings: Mutex::new(warnings) })
    }

    /// Reads an MCAP file that is in memory; `name` stands for its path in messages.
    ///
    /// # Errors
    /// If the bytes are not MCAP.
    pub fn from_bytes(name: &str, bytes: Vec<u8>) -> Result<Self, ReadError> {
        let mut warnings = BTreeSet::new();
        let file = OpenFile::in_memory(Path::new(name), bytes, &mut warnings)?;
        Ok(Self { path: PathBuf::from(name), files: vec![file], warnings: Mutex::new(warnings) })
    }

    /// The path it was opened by.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its files, in order.
    pub fn paths(&self) -> Vec<PathBuf> {
        self.files.iter().map(|f| f.path.clone()).collect()
    }

    /// What could not be read so far: damage inside a chunk shows when the chunk is read. Data was lost if
    /// this is not empty.
    pub fn warnings(&self) -> Vec<Warning> {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).iter().cloned().collect()
    }

    fn warn(&self, warning: Warning) {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).insert(warning);
    }

    /// The topics, sorted by name; a topic that files or channels repeat appears once.
    pub fn channels(&self) -> Vec<Arc<ChannelInfo>> {
        let mut by_topic = BTreeMap::new();
        for channel in self.files.iter().flat_map(|f| f.index.channels.values()) {
            by_topic.entry(channel.topic.clone()).or_insert_with(|| channel.clone());
        }
        by_topic.into_values().collect()
    }

    /// The topic of this name, with or without the leading slash.
    ///
    /// # Errors
    /// If there is none; the message lists those there are.
    pub fn channel(&self, topic: &str) -> Result<Arc<ChannelInfo>, ReadError> {
        let channels = self.channels();
        let wanted = topic.trim_start_matches('/');
        channels.iter().find(|c| c.topic.trim_start_matches('/') == wanted).cloned().ok_or_else(|| {
            let known = channels.iter().map(|c| c.topic.as_str()).collect::<Vec<_>>().join(", ");
            ReadError::NoSuchTopic { path: self.path.clone(), topic: topic.to_owned(), known }
        })
    }

    /// First and last log time, ns since 1970; `None` without messages.
    pub fn time_range(&self) -> Option<(u64, u64)> {
        let times = self.files.iter().flat_map(|f| &f.index.blocks).map(|b| (b.start, b.end));
        times.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// The messages selected, in order of log time; messages of equal log time in the order of the file.
    ///
    /// # Errors
    /// If a topic named does not exist.
    pub fn messages(&self, selection: &Selection) -> Result<Messages<'_>, ReadError> {
        let topics = match &selection.topics {
            None => None,
            Some(names) => Some(
                names
                    .iter()
                    .map(|n| Ok(self.channel(n)?.topic.clone()))
                    .collect::<Result<BTreeSet<_>, ReadError>>()?,
            ),
        };
        Ok(Messages::new(self, topics, selection.start.unwrap_or(0), selection.end.unwrap_or(u64::MAX)))
    }

    /// The last message on `topic` whose log time is below `time` (ns since 1970).
    ///
    /// # Errors
    /// If the topic does not exist.
    pub fn last_before(&self, topic: &str, time: u64) -> Result<Option<Message>, ReadError> {
        let topic = self.channel(topic)?.topic.clone();
        Ok(messages::last_before(self, &topic, time))
    }

    /// The files stored in the recording, in order.
    pub fn stored_files(&self) -> Vec<StoredFile> {
        self.files.iter().flat_map(|f| f.stored_files(|w| self.warn(w))).collect()
    }

    /// The metadata record of this name; the last one counts if there are several.
    pub fn metadata(&self, name: &str) -> Option<BTreeMap<String, String>> {
        self.files.iter().rev().find_map(|f| f.metadata(name, |w| self.warn(w)))
    }

    /// Names of the metadata records.
    pub fn metadata_names(&self) -> BTreeSet<String> {
        self.files.iter().flat_map(|f| f.index.metadata.iter().map(|m| m.name.clone())).collect()
    }

    /// The account of the recorders, if the recording was finished by ours: of several recorders one after the other, and
    /// of the files of each, as one. [`Recording::unaccounted`] names the files that it does not cover.
    pub fn ledger(&self) -> Option<Vec<TopicTally>> {
        let mut sessions = BTreeMap::new();
        for (order, file) in self.files.iter().enumerate() {
            if let Some((session, tallies)) = self.account(file) {
                // The last file of a recorder accounts for those before.
                let order = sessions.remove(&session).map_or(order, |(first, _)| first);
                sessions.insert(session, (order, tallies));
            }
        }
        let mut accounts: Vec<_> = sessions.into_values().collect();
        accounts.sort_by_key(|(order, _)| *order);
        if accounts.is_empty() {
            return None;
        }
        Some(ledger::merge(accounts.into_iter().map(|(_, tallies)| tallies).collect()))
    }

    /// The files that no recorder accounted for: it was killed, or is still at work.
    pub fn unaccounted(&self) -> Vec<PathBuf> {
        self.files.iter().filter(|f| self.account(f).is_none()).map(|f| f.path.clone()).collect()
    }

    /// What a file says of its recorder and of what that has recorded so far.
    fn account(&self, file: &OpenFile) -> Option<(String, Vec<TopicTally>)> {
        let metadata = file.metadata(METADATA_RECORD, |w| self.warn(w))?;
        let tallies = serde_json::from_str(metadata.get(LEDGER_KEY)?).ok()?;
        // Files of an earlier version say no session: each is one.
        let session = metadata.get(SESSION_KEY).cloned();
        Some((session.unwrap_or_else(|| file.path.display().to_string()), tallies))
    }

    /// Name, times and messages of each file.
    pub(crate) fn parts(&self) -> Vec<FileCount> {
        self.files.iter().map(OpenFile::count).collect()
    }

    /// Messages on a topic, by its full name.
    pub(crate) fn count(&self, topic: &str) -> u64 {
        self.files.iter().map(|f| f.count_of(topic)).sum()
    }

    /// An overview.
    pub fn info(&self) -> Info {
        info::of(self)
    }

    /// Reads everything and returns all that is wrong: every checksum, the index against the messages, log times that go
    /// back, and the account against what is there.
    pub fn verify(&self) -> Vec<Warning> {
        self.check().warnings
    }

    /// The same but for the account: of a recovered file it counts what could no longer be read, too.
    pub(crate) fn verify_files(&self) -> Vec<Warning> {
        verify::files(self)
    }

    /// The same as [`Recording::verify`], with what was found.
    pub fn check(&self) -> Check {
        verify::recording(self)
    }
}
