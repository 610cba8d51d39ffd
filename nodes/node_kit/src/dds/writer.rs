//! One DDS writer of this process.

use super::raw::{CDR_LE, HEADER, RawAdapter, RawPayload};
use crate::bus::Published;
use crate::bus_error::BusError;
use crate::sample::{SampleId, WriterId};
use rustdds::bytes::Bytes;
use rustdds::dds::WriteError;
use rustdds::no_key::DataWriter;
use rustdds::{GUID, RTPSEntity, SampleIdentity, SequenceNumber, Timestamp, WriteOptionsBuilder};
use std::collections::BTreeMap;

/// A writer and its statistics.
pub(super) struct Writer {
    pub(super) data: DataWriter<RawPayload, RawAdapter>,
    pub(super) guid: GUID,
    /// Resolved name.
    pub(super) topic: String,
    window: u32,
    count: u64,
    full: u64,
    /// Messages of other topics that were sent in parts.
    pub(super) wholes: BTreeMap<String, u64>,
}

impl Writer {
    /// A writer of a resolved topic; at most `window` samples may be unacknowledged.
    pub(super) fn new(data: DataWriter<RawPayload, RawAdapter>, topic: String, window: u32) -> Self {
        let guid = data.guid();
        Self { data, guid, topic, window, count: 0, full: 0, wholes: BTreeMap::new() }
    }

    pub(super) fn id(&self) -> WriterId {
        WriterId(self.guid.to_bytes())
    }

    /// Publishes a body with its encapsulation header and returns the sequence number.
    pub(super) fn write(&mut self, body: &[u8], about: Option<SampleId>) -> Result<i64, BusError> {
        if body.len() < HEADER || body[..2] != CDR_LE {
            let found = body[..body.len().min(HEADER)].to_vec();
            return Err(BusError::Encapsulation { topic: self.topic.clone(), found });
        }
        let payload = RawPayload(Bytes::copy_from_slice(&body[HEADER..]));
        let related = about.map(|sample| SampleIdentity {
            writer_guid: GUID::from_bytes(sample.writer.0),
            sequence_number: SequenceNumber::from(sample.sequence),
        });
        let options = WriteOptionsBuilder::new()
            .source_timestamp(Timestamp::now())
            .related_sample_identity_opt(related)
            .build();
        match self.data.write_with_options(payload, options) {
            Ok(identity) => {
                self.count += 1;
                Ok(i64::from(identity.sequence_number))
            }
            Err(WriteError::WouldBlock { .. }) => {
                self.full += 1;
                Err(BusError::Full { topic: self.topic.clone(), window: self.window })
            }
            Err(error) => Err(BusError::Network {
                what: format!("publish {}", self.topic),
                reason: match error {
                    WriteError::Serialization { reason, .. }
                    | WriteError::Poisoned { reason, .. }
                    | WriteError::Internal { reason, .. } => reason,
                    WriteError::WouldBlock { .. } => "window full".into(),
                    WriteError::Io(error) => error.to_string(),
                },
            }),
        }
    }

    /// Its statistics: messages sent in parts come before its own.
    pub(super) fn published(&self) -> Vec<Published> {
        let writer = self.id();
        let whole = |(topic, count): (&String, &u64)| Published {
            topic: topic.clone(),
            writer,
            count: *count,
            full: 0,
        };
        let own = Published { topic: self.topic.clone(), writer, count: self.count, full: self.full };
        self.wholes.iter().map(whole).chain([own]).collect()
    }
}
