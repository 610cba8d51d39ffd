//! One recorded message.

use super::channel::ChannelInfo;
use super::held::Content;
use grainlab_msgs::from_cdr;
use std::borrow::Cow;
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
    /// Topic and type.
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
    /// Bytes by the definition of this program, if that has a type of the name: fields in another order are read by
    /// their names, and messages of another type are refused.
    ///
    /// # Errors
    /// The difference between the two definitions.
    pub fn own_bytes(&self) -> Result<Cow<'_, [u8]>, String> {
        self.channel.stored.own(&self.payload)
    }

    /// The message as a type of this program.
    ///
    /// # Errors
    /// If it is another type, or not a valid message.
    pub fn decoded<T: grainlab_msgs::Message>(&self) -> Result<T, String> {
        if self.channel.ros_type != T::TYPE {
            return Err(format!("its type is {:?}, not {}", self.channel.ros_type, T::TYPE));
        }
        from_cdr(&self.own_bytes()?).map_err(|e| e.to_string())
    }

    /// True for the same message in another recording: topic, type, times and bytes. Recorders number differently.
    pub(crate) fn is_copy_of(&self, other: &Self) -> bool {
        let key = |m: &Self| (m.log_time, m.publish_time);
        let name = |m: &Self| (m.channel.topic.clone(), m.channel.ros_type.clone());
        key(self) == key(other) && name(self) == name(other) && *self.payload == *other.payload
    }

    /// True if topic, times, sequence and bytes are the same.
    pub(crate) fn says_the_same(&self, other: &Self) -> bool {
        let key = |m: &Self| (m.sequence, m.log_time, m.publish_time);
        key(self) == key(other) && *self.channel == *other.channel && *self.payload == *other.payload
    }
}
