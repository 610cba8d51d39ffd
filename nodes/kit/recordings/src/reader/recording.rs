//! An opened recording: its files, topics, stored files and ledger.

use super::channel::ChannelInfo;
use super::definition::StoredDefinition;
use super::error::{self, Warning, WarningKind, no_such_topic};
use super::file::{FileCount, OpenFile, StoredFile};
use super::files::{self, BagInformation};
use crate::definitions::Definitions;
use crate::ledger::{TopicTally, merge};
use crate::metadata_keys::{
    COPY_RECORD, ENDED_BY_KEY, LEDGER_KEY, METADATA_RECORD, RECOVERED_KEY, SESSION_KEY,
};
use grainlab_console::Failure;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// An opened recording.
#[derive(Debug)]
pub struct Recording {
    pub(super) path: PathBuf,
    pub(crate) files: Vec<OpenFile>,
    /// Content of the metadata.yaml that names its files.
    pub(crate) bag: Option<BagInformation>,
    /// True if each message is compressed by itself, by Zstandard.
    pub(crate) compressed: bool,
    /// The first channel of each topic.
    topics: BTreeMap<String, Arc<ChannelInfo>>,
    /// Types of records that MCAP does not define, as far as they were found.
    unknown: Mutex<BTreeSet<u8>>,
    warnings: Mutex<BTreeSet<Warning>>,
}

impl Recording {
    /// Opens an MCAP file, or a run directory: the files listed in its `metadata.yaml`, else all MCAP files
    /// in it.
    ///
    /// # Errors
    /// If there is no file, or it is not MCAP. A damaged recording is not an error: see
    /// [`Recording::warnings`].
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let mut warnings = BTreeSet::new();
        let bag = BagInformation::beside(path).unwrap_or_else(|fault| {
            let detail = format!("it cannot be read: {fault}");
            warnings.insert(Warning::of_file(path.join("metadata.yaml"), WarningKind::Inconsistent, detail));
            None
        });
        let compressed = bag.as_ref().is_some_and(|bag| bag.is_by("message"));
        if let Some(format) =
            bag.as_ref().map(|bag| &bag.compression_format).filter(|f| compressed && *f != "zstd")
        {
            return Err(Failure::failed(format!(
                "{}: its messages are compressed by {format:?}, which is not read: write it again with `ros2 bag convert`",
                path.display()
            )));
        }
        let mut paths = files::of_recording(path, bag.as_ref(), &mut warnings)?;
        // A recorder that has just begun its next file has written nothing to it, and metadata.yaml does not name it. If that recorder
        // is killed, the file stays.
        let is_empty = |file: &PathBuf| file.metadata().is_ok_and(|m| m.is_file() && m.len() == 0);
        let last = paths.last().cloned();
        let is_begun = |file: &PathBuf| {
            is_empty(file) && bag.as_ref().map_or(last.as_ref() == Some(file), |bag| !bag.names(file))
        };
        if paths.iter().any(|file| !is_begun(file)) {
            warnings.retain(|w| !is_begun(&w.path));
            paths.retain(|file| !is_begun(file));
        }
        let parts = paths.len();
        let mut files = Vec::with_capacity(parts);
        for file in paths {
            // A power cut may leave a part without a byte; the others are read.
            if parts > 1 && is_empty(&file) {
                let detail = "it is empty: what was recorded in it is lost";
                warnings.insert(Warning::of_file(file, WarningKind::Truncated, detail));
                continue;
            }
            files.push(OpenFile::map(&file, &mut warnings)?);
        }
        if files.is_empty() {
            return Err(error::empty(path));
        }
        let found: u64 = files.iter().flat_map(|f| f.index.counts.values()).sum();
        let stated = bag.as_ref().filter(|_| path.is_dir()).and_then(|bag| bag.differs(found));
        if let Some(detail) = stated.filter(|_| warnings.iter().all(|w| w.kind == WarningKind::Unread)) {
            warnings.insert(Warning::of_file(path.join("metadata.yaml"), WarningKind::Inconsistent, detail));
        }
        let topics = first_channels(&files);
        let unknown = files.iter().flat_map(|f| f.index.stored.unknown.iter().copied()).collect();
        let unknown = Mutex::new(unknown);
        let (path, warnings) = (path.to_owned(), Mutex::new(warnings));
        Ok(Self { path, files, bag, compressed, topics, unknown, warnings })
    }

    pub(super) fn size(&self) -> u64 {
        self.files.iter().map(OpenFile::size).sum()
    }

    /// Returns true if the index of a file is absent or lacks a part, which the format allows; such a file was read as a whole.
    pub fn is_without_index(&self) -> bool {
        self.files.iter().any(|f| f.index.absent)
    }

    /// The path passed to [`Recording::open`].
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Paths of the files, in order.
    pub fn paths(&self) -> Vec<PathBuf> {
        self.files.iter().map(|f| f.path.clone()).collect()
    }

    /// The parts that could not be read so far: damage inside a chunk is found when the chunk is read. Data was lost if
    /// this is not empty.
    pub fn warnings(&self) -> Vec<Warning> {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).iter().cloned().collect()
    }

    pub(crate) fn warn(&self, warning: Warning) {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).insert(warning);
    }

    pub(super) fn found_unknown(&self, opcode: u8) {
        self.unknown.lock().unwrap_or_else(PoisonError::into_inner).insert(opcode);
    }

    /// Types of the records read so far that MCAP does not define: private types (from 0x80) and types of a later version.
    pub(crate) fn unknown_records(&self) -> BTreeSet<u8> {
        self.unknown.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Returns name, encoding and content of each schema that no channel uses.
    pub(crate) fn unused_schemas(&self) -> impl Iterator<Item = (&str, &str, &[u8])> {
        self.files.iter().flat_map(|f| f.index.declared.unused_schemas())
    }

    /// The topics, sorted by name; a topic of several files or channels is listed once.
    pub fn channels(&self) -> Vec<Arc<ChannelInfo>> {
        self.topics.values().cloned().collect()
    }

    /// The topics by name and type, with a channel and the number of messages of each: a topic may have several types.
    pub(super) fn topics_by_type(&self) -> Vec<(Arc<ChannelInfo>, u64)> {
        let mut found = BTreeMap::new();
        for file in &self.files {
            for (id, channel) in &file.index.channels {
                let key = (channel.topic.clone(), channel.ros_type.clone(), channel.message_encoding.clone());
                let new = || (channel.clone(), 0);
                found.entry(key).or_insert_with(new).1 += file.index.counts.get(id).copied().unwrap_or(0);
            }
        }
        found.into_values().collect()
    }

    /// The topics whose definition is not that of this program, each with a line about it.
    pub fn differing(&self) -> Vec<String> {
        let line = |c: &Arc<ChannelInfo>| Some(format!("{} ({}): {}", c.topic, c.ros_type, c.stored.note()?));
        self.all_channels().filter_map(line).collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// Gives the channels without a definition the ones found for their types; returns topic and type of each of them.
    pub fn define(&mut self, definitions: &Definitions) -> BTreeSet<(String, String)> {
        let mut defined = BTreeSet::new();
        self.topics.clear();
        for channel in self.files.iter_mut().flat_map(|f| f.index.channels.values_mut()) {
            let is_open = channel.schema.is_empty() && channel.message_encoding == "cdr";
            let found = is_open.then(|| definitions.text(&channel.ros_type, &channel.type_hash));
            // The empty definition of a type without fields is complete.
            let is_new = |text: &String| channel.schema_encoding != "ros2msg" || !text.trim().is_empty();
            if let Some(text) = found.and_then(Result::ok).filter(is_new) {
                defined.insert((channel.topic.clone(), channel.ros_type.clone()));
                let new = Arc::make_mut(channel);
                new.stored = StoredDefinition::of(&new.ros_type, "ros2msg", &text, &new.type_hash);
                new.schema = text.clone().into_bytes();
                new.definition = text;
                new.schema_encoding = "ros2msg".to_owned();
            }
        }
        self.topics = first_channels(&self.files);
        defined
    }

    /// Those lines, and one for each topic whose definition is not in the recording and not known to this program.
    pub(super) fn definitions(&self) -> Vec<String> {
        let missing = self.all_channels().filter(|c| c.is_without_definition() && c.stored.note().is_none());
        let missing: BTreeSet<_> = missing.map(|c| format!("{}: {}", c.topic, c.advice())).collect();
        self.differing().into_iter().chain(missing).collect()
    }

    /// All channels of all files; a topic may have several, of several files or publishers.
    pub fn all_channels(&self) -> impl Iterator<Item = &Arc<ChannelInfo>> {
        self.files.iter().flat_map(|f| f.index.channels.values())
    }

    /// The profile in the header of the first file.
    pub(crate) fn profile(&self) -> &str {
        self.files.first().map_or("", |f| &f.index.profile)
    }

    /// The topic of this name, with or without the leading slash.
    ///
    /// # Errors
    /// If it does not exist; the message lists the existing ones.
    pub fn channel(&self, topic: &str) -> Result<Arc<ChannelInfo>, Failure> {
        let wanted = topic.trim_start_matches('/');
        // Two topics may differ by that slash.
        let exact = self.topics.get(topic);
        let found =
            exact.or_else(|| self.topics.values().find(|c| c.topic.trim_start_matches('/') == wanted));
        found.cloned().ok_or_else(|| {
            let known = self.topics.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
            no_such_topic(&self.path, topic, &known)
        })
    }

    /// Returns true if there is a topic of this complete name.
    pub(crate) fn has_topic(&self, name: &str) -> bool {
        self.topics.contains_key(name)
    }

    /// First and last log time, ns since 1970; `None` without messages.
    pub fn time_range(&self) -> Option<(u64, u64)> {
        self.files.iter().filter_map(OpenFile::bounds).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
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
        self.files.iter().flat_map(|f| f.index.stored.metadata.iter().map(|m| m.name.clone())).collect()
    }

    /// The ledger of the recorders, if a grainlab recorder finished the recording: that of several recorders
    /// one after the other, and of the files of each, as one. [`Recording::unaccounted`] lists the files that
    /// it does not cover.
    pub fn ledger(&self) -> Option<Vec<TopicTally>> {
        let mut sessions = BTreeMap::new();
        for (order, file) in self.files.iter().enumerate() {
            if let Some((session, tallies)) = self.account(file) {
                // The ledger of a recorder's last file covers its earlier files.
                let order = sessions.remove(&session).map_or(order, |(first, _)| first);
                sessions.insert(session, (order, tallies));
            }
        }
        let mut accounts: Vec<_> = sessions.into_values().collect();
        accounts.sort_by_key(|(order, _)| *order);
        if accounts.is_empty() {
            return None;
        }
        Some(merge(accounts.into_iter().map(|(_, tallies)| tallies).collect()))
    }

    /// The files of this program's recorder without a ledger: it was killed, could not write the ledger, or is still running.
    pub fn unaccounted(&self) -> Vec<PathBuf> {
        self.without_ledger(is_of_a_recorder)
    }

    /// Returns why the last recorder ended before its run did, as on a full disk; `None` if it did not. A recorder that went on with
    /// the run later makes up for an earlier one.
    pub fn ended_early(&self) -> Option<String> {
        let reason = self.files.last()?.metadata(METADATA_RECORD, |w| self.warn(w))?.remove(ENDED_BY_KEY)?;
        Some(format!("the recording ends early, because its recorder could not go on: {reason}"))
    }

    /// The files that were completed after their recorder was killed, with what was left out of them.
    pub(super) fn recovered(&self) -> BTreeMap<PathBuf, Vec<Warning>> {
        let without = |file: &OpenFile| {
            let parts = file.metadata(METADATA_RECORD, |w| self.warn(w))?.remove(RECOVERED_KEY)?;
            Some((file.path.clone(), serde_json::from_str(&parts).ok()?))
        };
        self.files.iter().filter_map(without).collect()
    }

    /// The files that never had a ledger: copies, and those of other programs.
    pub fn unjudged(&self) -> Vec<PathBuf> {
        self.without_ledger(|file| !is_of_a_recorder(file))
    }

    /// The files that this program did not write.
    pub fn foreign(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().filter(|f| !is_of_this_program(f)).map(|f| &*f.path)
    }

    fn without_ledger(&self, wanted: impl Fn(&OpenFile) -> bool) -> Vec<PathBuf> {
        let files = self.files.iter().filter(|f| wanted(f) && self.account(f).is_none());
        files.map(|f| f.path.clone()).collect()
    }

    fn account(&self, file: &OpenFile) -> Option<(String, Vec<TopicTally>)> {
        let metadata = file.metadata(METADATA_RECORD, |w| self.warn(w))?;
        let tallies = serde_json::from_str(metadata.get(LEDGER_KEY)?).ok()?;
        // Files of an earlier version have no session: each counts as one.
        let session = metadata.get(SESSION_KEY).cloned();
        Some((session.unwrap_or_else(|| file.path.display().to_string()), tallies))
    }

    pub(crate) fn parts(&self) -> Vec<FileCount> {
        self.files.iter().map(OpenFile::count).collect()
    }

    pub(crate) fn counts(&self) -> BTreeMap<&str, u64> {
        let mut counts = BTreeMap::new();
        for index in self.files.iter().map(|f| &f.index) {
            for (id, channel) in &index.channels {
                *counts.entry(channel.topic.as_str()).or_default() +=
                    index.counts.get(id).copied().unwrap_or(0);
            }
        }
        counts
    }
}

fn first_channels(files: &[OpenFile]) -> BTreeMap<String, Arc<ChannelInfo>> {
    let mut topics = BTreeMap::new();
    for channel in files.iter().flat_map(|f| f.index.channels.values()) {
        topics.entry(channel.topic.clone()).or_insert_with(|| channel.clone());
    }
    topics
}

/// Returns true for a file of a recorder, a recovery or a copy.
fn is_of_this_program(file: &OpenFile) -> bool {
    file.index.library.starts_with("grainlab ")
}

/// True if a recorder of this program wrote the file: such a file gets a ledger at its end.
fn is_of_a_recorder(file: &OpenFile) -> bool {
    is_of_this_program(file) && !file.index.stored.metadata.iter().any(|m| m.name == COPY_RECORD)
}
