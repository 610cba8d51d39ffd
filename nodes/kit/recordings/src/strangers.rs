//! Processes on the bus that are not part of the run, the writers of the results, and disputes between processes.

use crate::ledger::TopicTally;
use crate::metadata_keys::METADATA_RECORD;
use crate::reader::Recording;
use grainlab_msgs::Guid;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Key of the metadata record of a recording with the processes that are not part of the run.
pub const STRANGERS: &str = "strangers";

/// Key of the metadata record of a recording with the writers of the results.
pub const AUTHORS: &str = "authors";

/// Key of the metadata record of a recording with what makes it doubtful, one line each.
pub const DISPUTES: &str = "disputes";

/// Key of the metadata record of a recording with a sentence on the topics that its recorder left out.
pub const LEFT_OUT: &str = "left_out";

/// A process whose messages were left out of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StrangerView {
    /// Process, or DDS participant.
    pub who: String,
    /// The run that it claims to belong to.
    pub run: Option<String>,
    /// Messages left out, by topic.
    pub ignored: BTreeMap<String, u64>,
}

impl StrangerView {
    /// Text of one line.
    pub fn line(&self) -> String {
        let counts: Vec<String> = self.ignored.iter().map(|(topic, n)| format!("{n} on {topic}")).collect();
        format!("not of this run and left out: {}: {}", self.who, counts.join(", "))
    }
}

/// Writers of the results: log times and writers, by topic. A message in a recording does not contain its
/// writer.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Authors(BTreeMap<String, Vec<(u64, String)>>);

impl Authors {
    /// A message of `topic` was recorded at this log time.
    pub fn enter(&mut self, topic: &str, log_time: u64, writer: Guid) {
        self.0.entry(topic.to_owned()).or_default().push((log_time, writer.to_string()));
    }

    /// The writer of the message of `topic` at this log time.
    pub fn writer(&self, topic: &str, log_time: u64) -> Option<&str> {
        let known = self.0.get(topic)?;
        let place = known.binary_search_by_key(&log_time, |(time, _)| *time).ok()?;
        Some(&known[place].1)
    }
}

/// The strangers in a recording.
pub fn strangers(recording: &Recording) -> Vec<StrangerView> {
    read(recording, STRANGERS).unwrap_or_default()
}

/// The writers of the results in a recording.
pub fn authors(recording: &Recording) -> Authors {
    read(recording, AUTHORS).unwrap_or_default()
}

/// Doubts that the recorders of a recording noted: two processes of one name or one task, another scene.
pub fn noted_disputes(recording: &Recording) -> Vec<String> {
    read(recording, DISPUTES).unwrap_or_default()
}

/// A sentence on the topics that the recorder of a run left out, with what to do.
pub fn left_out(recording: &Recording) -> Option<String> {
    recording.metadata(METADATA_RECORD)?.remove(LEFT_OUT)
}

/// Why it is unknown which messages of a recording are right, one line each: what its recorders noted, and messages
/// that contradict recorded ones.
pub fn disputes(recording: &Recording) -> Vec<String> {
    let tallies = recording.ledger().unwrap_or_default();
    let of_messages = tallies.iter().filter_map(TopicTally::dispute);
    noted_disputes(recording).into_iter().chain(of_messages).collect()
}

fn read<T: for<'a> Deserialize<'a>>(recording: &Recording, key: &str) -> Option<T> {
    serde_json::from_str(recording.metadata(METADATA_RECORD)?.get(key)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_writer_of_a_result_is_found_by_its_log_time() {
        let mut authors = Authors::default();
        authors.enter("/microstructure", 5, Guid([1; 16]));
        authors.enter("/microstructure", 9, Guid([2; 16]));
        let authors: Authors = serde_json::from_str(&serde_json::to_string(&authors).unwrap()).unwrap();
        assert_eq!(authors.writer("/microstructure", 9), Some(Guid([2; 16]).to_string().as_str()));
        assert_eq!(authors.writer("/microstructure", 6), None);
        assert_eq!(authors.writer("/moduli", 9), None);
    }
}
