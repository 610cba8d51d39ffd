//! Writes the readable part of a file again, as a complete file.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use mcap::records::{MessageHeader, Metadata, Record, op};
use mcap::write::PrivateRecordOptions;
use mcap::{Attachment, McapError};

use crate::metadata_keys::{METADATA_RECORD, RECOVERED_KEY};
use crate::reader::{Recording, Walked, Warning, WarningKind, is_misplaced, is_unknown, place, walk};
use crate::writer::part;

pub(super) struct Written {
    pub(super) messages: u64,
    pub(super) unreadable: Vec<Warning>,
}

/// Writes the readable part of the only file of `from` to the new file `to`, and syncs it to the device.
pub(super) fn rewrite(from: &Recording, to: &Path) -> Result<Written, McapError> {
    let profile = from.profile();
    // A file that contradicts itself is read in one way of several.
    let mut unreadable = from.warnings();
    unreadable.retain(|w| matches!(w.kind, WarningKind::Inconsistent | WarningKind::AfterEnd));
    let [from] = &from.files[..] else { return Err(io::Error::other("it has several files").into()) };
    // An earlier attempt may have left a file; a link is not followed.
    let _ = std::fs::remove_file(to);
    let file = File::create_new(to)?;
    let mcap = part::options(" (recovered)")
        .profile(profile)
        // Chunks end as in the original.
        .chunk_size(None)
        .create(BufWriter::with_capacity(64 << 10, file))?;
    let mut copy = Copy {
        mcap,
        channels: BTreeMap::new(),
        orphans: BTreeSet::new(),
        known: BTreeMap::new(),
        messages: 0,
    };
    for (id, channel) in from.channels() {
        copy.channels.insert(id, channel.declare(&mut copy.mcap)?);
    }
    let (mut failure, mut ended) = (None, false);
    let end = walk(from.bytes(), &mut |item| {
        let outcome = match item {
            Walked::Record(record, chunk) => match record.opcode {
                op::CHUNK | op::MESSAGE_INDEX | op::HEADER => Ok(()),
                op::DATA_END => {
                    ended = true;
                    Ok(())
                }
                opcode if chunk.is_some() && is_misplaced(opcode) => Ok(()),
                // The writer writes private records only.
                opcode @ ..0x80 if is_unknown(opcode) => {
                    let (at, kind) = (chunk.unwrap_or(record.offset), WarningKind::Inconsistent);
                    let detail =
                        format!("a record of type 0x{opcode:02x}, which MCAP does not define, is left out");
                    unreadable.push(from.warning(at, kind, detail));
                    Ok(())
                }
                _ => match record.parse() {
                    Ok(record) => copy.record(record, chunk.is_some()),
                    Err(detail) => {
                        let (at, kind) = place(&record, chunk);
                        unreadable.push(from.warning(at, kind, detail));
                        Ok(())
                    }
                },
            },
            Walked::ChunkEnd(_) => copy.mcap.flush(),
            Walked::Unreadable(at, kind, detail) => {
                unreadable.push(from.warning(at, kind, detail));
                Ok(())
            }
        };
        failure = outcome.err();
        failure.is_none()
    });
    if let Some(failure) = failure {
        return Err(failure);
    }
    let left = from.bytes().len() - end;
    if !ended && left > 0 {
        let detail = format!("its last {left} bytes are an incomplete record");
        unreadable.push(from.warning(end, WarningKind::Truncated, detail));
    }
    for channel in &copy.orphans {
        let detail = format!("messages of channel {channel}, whose declaration was lost, are left out");
        unreadable.push(from.warning(0, WarningKind::Orphans, detail));
    }
    copy.finish(unreadable)
}

struct Copy {
    mcap: mcap::Writer<BufWriter<File>>,
    /// Id in the old file → id in the new one.
    channels: BTreeMap<u16, u16>,
    /// Channels with messages whose declaration was lost.
    orphans: BTreeSet<u16>,
    /// The recorder's metadata of the run, if it was written.
    known: BTreeMap<String, String>,
    messages: u64,
}

impl Copy {
    fn record(&mut self, record: Record<'_>, in_chunk: bool) -> Result<(), McapError> {
        match record {
            Record::Message { header, data } => self.message(&header, &data)?,
            Record::Attachment { header, data, .. } => self.mcap.attach(&Attachment {
                log_time: header.log_time,
                create_time: header.create_time,
                name: header.name,
                media_type: header.media_type,
                data: Cow::Borrowed(&data),
            })?,
            // Written at the end, with the additions of the recovery.
            Record::Metadata(m) if m.name == METADATA_RECORD => self.known = m.metadata,
            Record::Metadata(m) => self.mcap.write_metadata(&m)?,
            // Those of channels are known already.
            Record::Schema { header, data } if header.id != 0 => {
                self.mcap.add_schema(&header.name, &header.encoding, &data)?;
            }
            Record::Unknown { opcode: opcode @ 0x80.., data } => {
                let place = PrivateRecordOptions::IncludeInChunks;
                let options = if in_chunk { place.into() } else { Default::default() };
                self.mcap.write_private_record(opcode, &data, options)?;
            }
            _ => {}
        }
        Ok(())
    }

    fn message(&mut self, header: &MessageHeader, data: &[u8]) -> Result<(), McapError> {
        let Some(channel_id) = self.channels.get(&header.channel_id).copied() else {
            self.orphans.insert(header.channel_id);
            return Ok(());
        };
        self.mcap.write_to_known_channel(&MessageHeader { channel_id, ..*header }, data)?;
        self.messages += 1;
        Ok(())
    }

    fn finish(mut self, unreadable: Vec<Warning>) -> Result<Written, McapError> {
        let mut metadata = std::mem::take(&mut self.known);
        metadata.insert("recovered".into(), "true".into());
        metadata.entry("finished".into()).or_insert_with(|| "false".into());
        metadata.insert(RECOVERED_KEY.into(), serde_json::to_string(&unreadable).unwrap_or_default());
        self.mcap.write_metadata(&Metadata { name: METADATA_RECORD.into(), metadata })?;
        self.mcap.finish()?;
        let file = self.mcap.into_inner().into_inner().map_err(io::IntoInnerError::into_error)?;
        file.sync_all()?;
        Ok(Written { messages: self.messages, unreadable })
    }
}
