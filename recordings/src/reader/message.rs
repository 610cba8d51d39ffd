//! One recorded message.

use super::channel::ChannelInfo;
use super::held::Content;
use std::ops::{Deref, Range};
use std::sync::Arc;

/// Bytes of a message, shared with its chunk.
#[derive(Clone)]
pub struct Payload {
    pub(super) chunk: Arc<Content>,
    pub(super) range: Range<usize>,
}

impl Deref for Payload {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.chunk.bytes()[self.range.clone()]
    }
}

impl std::fmt::Debug for Payload {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} bytes", self.range.len())
    }
}

/// One recorded message.
#[derive(Clone, Debug)]
pub struct Message {
    /// Its topic.
    pub channel: Arc<ChannelInfo>,
    /// Low half of its RTPS sequence number in recordings of grainlab, 0 in those of rosbag2.
    pub sequence: u32,
    /// Time of arrival, ns since 1970.
    pub log_time: u64,
    /// Time of writing, ns since 1970.
    pub publish_time: u64,
    /// As sent: in CDR, with the 4-byte encapsulation header.
    pub payload: Payload,
}

impl Message {
    /// Whether topic, times, sequence and bytes are the same.
    pub(crate) fn says_the_same(&self, other: &Self) -> bool {
        let key = |m: &Self| (m.sequence, m.log_time, m.publish_time);
        key(self) == key(other) && *self.channel == *other.channel && *self.payload == *other.payload
    }
}
