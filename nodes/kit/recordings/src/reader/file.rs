//! One MCAP file.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use grainlab_console::Failure;
use mcap::MAGIC;
use mcap::records::{Metadata, Record};
use memmap2::Mmap;

use grainlab_console::input;

use super::block::Block;
use super::channel::ChannelInfo;
use super::entry::Entry;
use super::error::{Warning, WarningKind, not_mcap};
use super::held::Content;
use super::index::Index;
use super::records::Records;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FileCount {
    pub(crate) name: String,
    /// First and last log time, ns since 1970; `None` without messages.
    pub(crate) bounds: Option<(u64, u64)>,
    pub(crate) messages: u64,
}

/// An attachment: a file stored in a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredFile {
    /// Name within the recording.
    pub name: String,
    /// Media type, as in `application/toml`.
    pub media_type: String,
    /// Time at which it was stored, ns since 1970.
    pub time: u64,
    /// Time at which it was made, ns since 1970.
    pub created: u64,
    /// Content of the file.
    pub bytes: Vec<u8>,
}

pub(crate) struct OpenFile {
    pub(super) path: PathBuf,
    bytes: Arc<Mmap>,
    pub(super) index: Index,
}

impl fmt::Debug for OpenFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OpenFile").field("path", &self.path).finish_non_exhaustive()
    }
}

impl OpenFile {
    pub(super) fn map(path: &Path, warnings: &mut BTreeSet<Warning>) -> Result<Self, Failure> {
        let (file, size) = input::open(path).map_err(Failure::at(path))?;
        if size == 0 {
            return Err(not_mcap(path, &[]));
        }
        // SAFETY: the mapping is read-only; the user must ensure that no process shortens the file meanwhile
        // (see the module).
        let bytes = Arc::new(unsafe { Mmap::map(&file) }.map_err(Failure::at(path))?);
        if !bytes.starts_with(MAGIC) {
            return Err(not_mcap(path, &bytes));
        }
        let index = Index::build(path, &bytes, warnings);
        Ok(Self { path: path.to_owned(), bytes, index })
    }

    /// The bytes of the recording, without those that follow its end in the file.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes[..self.index.length]
    }

    pub(super) fn size(&self) -> u64 {
        self.bytes.len() as u64
    }

    pub(super) fn part(&self, range: Range<usize>) -> Content {
        Content::Part { file: Arc::clone(&self.bytes), range }
    }

    pub(crate) fn channels(&self) -> impl Iterator<Item = (u16, &ChannelInfo)> {
        self.index.channels.iter().map(|(id, channel)| (*id, &**channel))
    }

    /// The blocks of messages, in order of start, then of offset.
    pub(super) fn blocks(&self) -> &[Block] {
        &self.index.blocks
    }

    /// First and last log time; `None` without messages.
    pub(super) fn bounds(&self) -> Option<(u64, u64)> {
        let blocks = self.blocks().iter().map(|b| (b.start, b.end));
        blocks.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    pub(crate) fn warning(&self, offset: usize, kind: WarningKind, detail: String) -> Warning {
        Warning { path: self.path.clone(), offset: offset as u64, kind, detail }
    }

    pub(super) fn count(&self) -> FileCount {
        FileCount {
            name: self.path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default(),
            bounds: self.bounds(),
            messages: self.index.counts.values().sum(),
        }
    }

    pub(crate) fn stored_files(&self, warn: impl Fn(Warning)) -> Vec<StoredFile> {
        let read = |entry: &Entry| match self.record(entry) {
            Ok(Record::Attachment { header, data, .. }) => {
                let (time, created, bytes) = (header.log_time, header.create_time, data.into_owned());
                Some(StoredFile { name: header.name, media_type: header.media_type, time, created, bytes })
            }
            outcome => {
                warn(self.damaged(entry, outcome.err()));
                None
            }
        };
        self.index.stored.attachments.iter().filter_map(read).collect()
    }

    pub(super) fn metadata(&self, name: &str, warn: impl Fn(Warning)) -> Option<BTreeMap<String, String>> {
        self.all_metadata(warn).filter(|m| m.name == name).last().map(|m| m.metadata)
    }

    /// The metadata records, in order.
    pub(crate) fn all_metadata(&self, warn: impl Fn(Warning)) -> impl Iterator<Item = Metadata> {
        self.index.stored.metadata.iter().filter_map(move |entry| match self.record(entry) {
            Ok(Record::Metadata(m)) => Some(m),
            outcome => {
                warn(self.damaged(entry, outcome.err()));
                None
            }
        })
    }

    fn record(&self, entry: &Entry) -> Result<Record<'_>, String> {
        Records::at(self.bytes(), entry.offset).ok_or("the record is incomplete")?.parse()
    }

    fn damaged(&self, entry: &Entry, detail: Option<String>) -> Warning {
        let detail = detail.unwrap_or_else(|| "it differs from the index".into());
        let detail = format!("{} cannot be read: {detail}", entry.name);
        self.warning(usize::try_from(entry.offset).unwrap_or(usize::MAX), WarningKind::DamagedRecord, detail)
    }
}
