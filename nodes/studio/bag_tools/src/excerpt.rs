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
    /// Opens the recording, and selects its messages.
    pub(crate) fn open(&self, messages: &MessagePath) -> Result<(Recording, Selection), Failure> {
        let (recording, _) = messages.open(&self.path)?;
        self.topics.check(from_ref(&recording))?;
        let (start, end) = self.interval.of(from_ref(&recording))?;
        let wanted = recording.channels().into_iter().filter(|c| self.topics.take(c));
        let topics = Some(wanted.map(|c| c.topic.clone()).collect());
        Ok((recording, Selection { topics, start, end }))
    }
}
