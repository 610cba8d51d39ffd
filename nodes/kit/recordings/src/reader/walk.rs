//! Reads all readable parts of one file in order, without its index.

use mcap::MAGIC;
use mcap::records::op;

use super::chunk;
use super::end;
use super::error::WarningKind;
use super::records::{RawRecord, Records};

pub(crate) enum Walked<'a> {
    /// A record, and the byte of the chunk that it is in.
    Record(RawRecord<'a>, Option<usize>),
    ChunkEnd(RawRecord<'a>),
    /// An unreadable part: its byte, its kind, and what is wrong.
    Unreadable(usize, WarningKind, String),
}

/// The byte and the kind of a fault in a record.
pub(crate) fn place(record: &RawRecord<'_>, chunk: Option<usize>) -> (usize, WarningKind) {
    chunk.map_or((record.offset, WarningKind::DamagedRecord), |at| (at, WarningKind::DamagedChunk))
}

/// Passes all items of a file to `take` until the end of the data, an incomplete record, or `take` stops. Returns the byte after the
/// last record that was passed. Records between the end record of the data and the summary are passed like those before.
pub(crate) fn walk(bytes: &[u8], take: &mut dyn FnMut(Walked<'_>) -> bool) -> usize {
    let (mut end, mut ended, summary) = (MAGIC.len(), false, end::summary(bytes));
    for record in Records::new(bytes, end).map_while(Result::ok) {
        if ended && record.offset >= summary {
            break;
        }
        end = record.end();
        ended |= record.opcode == op::DATA_END;
        let go_on = take(Walked::Record(record, None))
            && match record.opcode {
                op::CHUNK => match chunk::content(&record) {
                    Ok(content) => inside(&content, &record, take),
                    Err(detail) => take(Walked::Unreadable(record.offset, WarningKind::DamagedChunk, detail)),
                },
                _ => true,
            };
        if !go_on {
            break;
        }
    }
    end
}

fn inside(content: &[u8], chunk: &RawRecord<'_>, take: &mut dyn FnMut(Walked<'_>) -> bool) -> bool {
    for record in Records::new(content, 0) {
        let item = match record {
            Ok(record) => Walked::Record(record, Some(chunk.offset)),
            Err(at) => {
                let detail = format!("an incomplete record starts at byte {at} of its content");
                Walked::Unreadable(chunk.offset, WarningKind::DamagedChunk, detail)
            }
        };
        if !take(item) {
            return false;
        }
    }
    take(Walked::ChunkEnd(*chunk))
}
