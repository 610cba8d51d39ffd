//! A complete check of one file.

use std::collections::BTreeMap;

use mcap::MAGIC;
use mcap::records::{Record, op};

use super::file::OpenFile;
use super::records::{FRAME, RawRecord, Records};
use super::{Warning, WarningKind, chunk, messages};

/// Reports everything in `file` that is damaged or contradicts its index.
pub(super) fn file(file: &OpenFile, mut warn: impl FnMut(Warning)) {
    let mut counts = BTreeMap::<u16, u64>::new();
    let mut ended = false;
    for record in Records::new(file.bytes(), MAGIC.len()) {
        let record = match record {
            Ok(record) => record,
            Err(at) => {
                // Of a file without its proper end, opening it has said so.
                if file.index.complete {
                    let detail = "no whole record starts here; what follows can be reached by the index only"
                        .to_owned();
                    warn(file.warning(at, WarningKind::Inconsistent, detail));
                }
                break;
            }
        };
        match record.opcode {
            op::CHUNK => match chunk::content(&record) {
                Ok(content) => count(&content, &mut counts),
                Err(detail) => warn(file.warning(record.offset, WarningKind::DamagedChunk, detail)),
            },
            op::MESSAGE => count_one(&record, &mut counts),
            op::DATA_END => {
                if let Some(detail) = data_checksum(file, &record) {
                    warn(file.warning(record.offset, WarningKind::Inconsistent, detail));
                }
                ended = true;
                break;
            }
            _ => {
                if let Err(detail) = record.parse() {
                    warn(file.warning(record.offset, WarningKind::DamagedRecord, detail));
                }
            }
        }
    }
    if file.index.complete && !ended {
        return;
    }
    counts.retain(|channel, _| file.index.channels.contains_key(channel));
    for (channel, info) in &file.index.channels {
        let claimed = file.index.counts.get(channel).copied().unwrap_or(0);
        let found = counts.get(channel).copied().unwrap_or(0);
        if claimed != found {
            let detail =
                format!("the index counts {claimed} messages on {}, the file holds {found}", info.topic);
            warn(file.warning(file.bytes().len(), WarningKind::Inconsistent, detail));
        }
    }
}

fn count(content: &[u8], counts: &mut BTreeMap<u16, u64>) {
    for record in Records::new(content, 0).flatten().filter(|r| r.opcode == op::MESSAGE) {
        count_one(&record, counts);
    }
}

fn count_one(record: &RawRecord<'_>, counts: &mut BTreeMap<u16, u64>) {
    if let Some((header, _)) = messages::message(record) {
        *counts.entry(header.channel_id).or_default() += 1;
    }
}

fn data_checksum(file: &OpenFile, end: &RawRecord<'_>) -> Option<String> {
    let Ok(Record::DataEnd(claimed)) = end.parse() else {
        return Some(format!("the end record has {} bytes", end.body.len() + FRAME));
    };
    let crc = crc32fast::hash(&file.bytes()[..end.offset]);
    // 0 stands for "not computed".
    (claimed.data_section_crc != 0 && claimed.data_section_crc != crc).then(|| {
        format!(
            "the checksum of the whole data is {crc:08x}, not {:08x}: bytes were altered",
            claimed.data_section_crc
        )
    })
}
