//! Reads all readable parts of one file in order, without its index.

use std::collections::BTreeSet;
use std::path::Path;

use mcap::MAGIC;
use mcap::records::{Record, op};

use super::chunk;
use super::error::{ReadError, Warning, WarningKind};
use super::file::OpenFile;
use super::records::Records;

/// An item of the walk.
pub(crate) enum Walked<'a> {
    /// A schema, a channel, a message, an attachment or a metadata record.
    Record(Record<'a>),
    /// A chunk ends here.
    ChunkEnd,
    /// An unreadable part.
    Unreadable(Warning),
}

/// A file to walk over.
pub(crate) struct Walk {
    file: OpenFile,
}

impl Walk {
    /// Opens the file.
    pub(crate) fn open(path: &Path) -> Result<Self, ReadError> {
        Ok(Self { file: OpenFile::map(path, &mut BTreeSet::new())? })
    }

    /// The profile in its header.
    pub(crate) fn profile(&self) -> &str {
        &self.file.index.profile
    }

    /// Warnings about messages whose channel was lost.
    pub(crate) fn orphans(&self, channel: u16) -> Warning {
        let detail = format!("messages of channel {channel}, whose declaration was lost, are left out");
        self.file.warning(0, WarningKind::Orphans, detail)
    }

    /// Passes all items to `take` until the end of the data, an incomplete record, or `take` stops.
    pub(crate) fn each(&self, take: &mut dyn FnMut(Walked<'_>) -> bool) {
        let bytes = self.file.bytes();
        let mut end = MAGIC.len();
        for record in Records::new(bytes, MAGIC.len()) {
            let record = match record {
                Ok(record) if record.opcode == op::DATA_END => return,
                Ok(record) => record,
                Err(at) => {
                    end = at;
                    break;
                }
            };
            end = record.end();
            let unreadable =
                |kind, detail| Walked::Unreadable(self.file.warning(record.offset, kind, detail));
            let go_on = match record.opcode {
                op::MESSAGE_INDEX | op::HEADER => true,
                op::CHUNK => match chunk::content(&record) {
                    Ok(content) => self.chunk(&content, record.offset, take),
                    Err(detail) => take(unreadable(WarningKind::DamagedChunk, detail)),
                },
                _ => match record.parse() {
                    Ok(record) => take(Walked::Record(record)),
                    Err(detail) => take(unreadable(WarningKind::DamagedRecord, detail)),
                },
            };
            if !go_on {
                return;
            }
        }
        let left = bytes.len() - end;
        if left > 0 {
            let detail = format!("its last {left} bytes are an incomplete record");
            take(Walked::Unreadable(self.file.warning(end, WarningKind::Truncated, detail)));
        }
    }

    fn chunk(&self, content: &[u8], offset: usize, take: &mut dyn FnMut(Walked<'_>) -> bool) -> bool {
        for inner in Records::new(content, 0) {
            let parsed = match inner {
                Ok(inner) => inner.parse(),
                Err(at) => Err(format!("an incomplete record starts at byte {at} of its content")),
            };
            let walked = match parsed {
                Ok(record) => Walked::Record(record),
                Err(detail) => {
                    Walked::Unreadable(self.file.warning(offset, WarningKind::DamagedChunk, detail))
                }
            };
            if !take(walked) {
                return false;
            }
        }
        take(Walked::ChunkEnd)
    }
}
