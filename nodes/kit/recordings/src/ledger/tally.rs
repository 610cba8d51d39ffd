//! Counts of topics and writers.

use grainlab_console::count;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Counts of one topic, all writers together.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TopicTally {
    /// Name of the topic, absolute.
    pub name: String,
    /// Messages published: a writer's own count if reported or announced, else its highest received sequence number. The sum of
    /// `recorded`, `repeated`, `conflicting` and `lost`.
    pub published: u64,
    /// Messages in the recording.
    pub recorded: u64,
    /// Published but not recorded.
    pub lost: u64,
    /// Published again with the bytes of a recorded message, for example a request without an answer; not
    /// recorded again.
    pub repeated: u64,
    /// Not recorded because another message is in their place: two processes sent them, and it is unknown which is right.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub conflicting: u64,
    /// Deliveries of a message that was received before; not counted as published.
    #[serde(default)]
    pub redelivered: u64,
    /// The writers, in order of GUID.
    pub writers: Vec<WriterTally>,
}

/// Counts of one writer of one topic.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WriterTally {
    /// GUID, 32 hexadecimal digits.
    pub guid: String,
    /// Name of the node, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub node: Option<String>,
    /// Number of messages recorded.
    pub recorded: u64,
    /// Count that the writer reported or announced; `None` without either.
    pub reported: Option<u64>,
    /// Lowest sequence number recorded; `None` if nothing was.
    pub first: Option<i64>,
    /// Highest sequence number recorded; `None` if nothing was.
    pub last: Option<i64>,
    /// Lowest sequence number that reached the recorder and could not be received.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<i64>,
    /// Published but not recorded.
    pub lost: u64,
    /// Ranges of sequence numbers, both ends included, that are missing below the highest received one. At most
    /// 32 are kept here; `lost` counts all.
    pub gaps: Vec<(i64, i64)>,
    /// Published again with the bytes of a recorded message.
    pub repeated: u64,
    /// Not recorded because another message is in their place.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub conflicting: u64,
    /// Received and not recorded, because their writer is not of the run.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub left_out: u64,
    /// Deliveries of a message that was received before.
    #[serde(default)]
    pub redelivered: u64,
}

impl TopicTally {
    /// That messages contradict recorded ones, with the processes that sent either; `None` if none do.
    pub fn dispute(&self) -> Option<String> {
        let of = |wanted: fn(&WriterTally) -> bool| {
            let names = self.writers.iter().filter(|w| wanted(w)).map(|w| w.node.as_ref().unwrap_or(&w.guid));
            names.cloned().collect::<BTreeSet<_>>().into_iter().collect::<Vec<_>>().join(", ")
        };
        (self.conflicting > 0).then(|| {
            format!(
                "{}: {} of {} contradict those recorded in their place, of {}: it is unknown which are right",
                self.name,
                count(self.conflicting, "message"),
                of(|w| w.conflicting > 0),
                of(|w| w.recorded > 0)
            )
        })
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(count: &u64) -> bool {
    *count == 0
}

pub(super) const LISTED_GAPS: usize = 32;
