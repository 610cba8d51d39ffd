//! Positions of stored files and metadata records.

use std::collections::BTreeSet;

use grainlab_console::count;
use mcap::records::{Statistics, op};

use super::records::{RawRecord, is_unknown};

/// Position of a metadata record or an attachment.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Entry {
    pub(super) offset: u64,
    pub(super) name: String,
}

/// The attachments and metadata records of a file, in order.
#[derive(Clone, Debug, Default)]
pub(super) struct StoredEntries {
    pub(super) attachments: Vec<Entry>,
    pub(super) metadata: Vec<Entry>,
    /// Types of records that MCAP does not define, as far as they were found without reading chunks that have messages.
    pub(super) unknown: BTreeSet<u8>,
}

impl StoredEntries {
    /// Adds an attachment, a metadata record, or the type of a record that MCAP does not define; ignores other records.
    pub(super) fn add(&mut self, record: &RawRecord<'_>) {
        let (list, name) = match record.opcode {
            // Two times come before the name of an attachment.
            op::ATTACHMENT => (&mut self.attachments, record.body.get(16..).and_then(text)),
            op::METADATA => (&mut self.metadata, text(record.body)),
            opcode => {
                self.unknown.extend(is_unknown(opcode).then_some(opcode));
                return;
            }
        };
        list.push(Entry { offset: record.offset as u64, name: name.unwrap_or_default() });
    }

    /// Returns the first contradiction of the entries in an index, and of the counts in its statistics, to the entries in the
    /// data. An index may lack all entries of a kind, and the data may lack entries if a record in it is `damaged`.
    pub(super) fn contradiction(&self, listed: &Self, counted: &Statistics, damaged: bool) -> Option<String> {
        let stated = [counted.attachment_count, counted.metadata_count].map(u64::from);
        let there = [&self.attachments, &self.metadata];
        let listed = [&listed.attachments, &listed.metadata];
        ["stored file", "metadata record"].into_iter().enumerate().find_map(|(kind, what)| {
            let found = there[kind].len() as u64;
            if stated[kind] < found || stated[kind] > found && !damaged {
                return Some(format!("{} by its statistics, {found} in the file", count(stated[kind], what)));
            }
            let [there, listed] =
                [there[kind], listed[kind]].map(|list| list.iter().collect::<BTreeSet<_>>());
            let named = |entry: &Entry| format!("{what} {:?} at byte {}", entry.name, entry.offset);
            let lacks =
                there.difference(&listed).next().map(|entry| format!("it lacks the {}", named(entry)));
            let more = || {
                let other = listed.difference(&there).next().filter(|_| !damaged);
                other.map(|entry| format!("there is no {}", named(entry)))
            };
            lacks.or_else(more).filter(|_| !listed.is_empty())
        })
    }
}

/// Returns the text at the beginning of `bytes`, behind its length of four bytes.
fn text(bytes: &[u8]) -> Option<String> {
    let (length, rest) = bytes.split_first_chunk::<4>()?;
    let text = rest.get(..u32::from_le_bytes(*length) as usize)?;
    Some(String::from_utf8_lossy(text).into_owned())
}
