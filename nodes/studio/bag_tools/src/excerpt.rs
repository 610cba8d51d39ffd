//! A recording on the command line, and its messages that are wanted.

use crate::selection::Topics;
use crate::times::Interval;
use grainlab_console::Failure;
use grainlab_recordings::{MessagePath, Recording, Selection};
use std::path::PathBuf;
use std::slice::from_ref;

/// A recording, and the messages of it that are wanted.
#[derive(Clone, Debug, clap::Args)]
pub struct Excerpt {
    /// Run directory or MCAP file
    #[arg(value_name = "PATH")]
    pub(crate) path: PathBuf,
    #[command(flatten)]
    pub(crate) topics: Topics,
    #[command(flatten)]
    pub(crate) interval: Interval,
}

impl Excerpt {
    /// Opens the recording, and selects its messages; the last is the channels wanted, where not all of a topic are.
    pub(crate) fn open(
        &self,
        messages: &MessagePath,
    ) -> Result<(Recording, Selection, Option<Topics>), Failure> {
        let (recording, _) = messages.open(&self.path)?;
        let found = self.topics.check(from_ref(&recording))?;
        let (start, end) = self.interval.of(from_ref(&recording))?;
        let wanted = recording.all_channels().filter(|c| found.take(c));
        let topics = Some(wanted.map(|c| c.topic.clone()).collect());
        Ok((recording, Selection { topics, start, end }, found.has_types().then_some(found)))
    }
}
