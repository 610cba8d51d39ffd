//! One DDS writer of this process.

use super::direct::{CDR_BE, CDR_LE, HEADER, Outlet, WriteFailure};
use crate::bus::Published;
use crate::bus_error::BusError;
use crate::sample::{SampleId, WriterId};
use ros2_client::Gid;
use std::collections::BTreeMap;

/// A writer and its statistics.
pub(super) struct Writer {
    pub(super) outlet: Outlet,
    pub(super) gid: Gid,
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
    pub(super) fn new(outlet: Outlet, topic: String, window: u32) -> Self {
        let gid = outlet.gid();
        Self { outlet, gid, topic, window, count: 0, full: 0, wholes: BTreeMap::new() }
    }

    pub(super) fn id(&self) -> WriterId {
        WriterId(self.gid.to_bytes16())
    }

    /// Publishes a body with its encapsulation header and returns the sequence number.
    pub(super) fn write(&mut self, body: &[u8], about: Option<SampleId>) -> Result<i64, BusError> {
        if body.len() < HEADER || ![CDR_LE, CDR_BE].contains(&[body[0], body[1]]) {
            let found = body[..body.len().min(HEADER)].to_vec();
            return Err(BusError::Encapsulation { topic: self.topic.clone(), found });
        }
        match self.outlet.write(body, about) {
            Ok(sequence) => {
                self.count += 1;
                Ok(sequence)
            }
            Err(WriteFailure::Full) => {
                self.full += 1;
                Err(BusError::Full { topic: self.topic.clone(), window: self.window })
            }
            Err(WriteFailure::Other(reason)) => {
                Err(BusError::Network { what: format!("publish {}", self.topic), reason })
            }
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
