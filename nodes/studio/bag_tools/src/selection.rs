//! Topics and an interval on the command line.

use crate::times::Interval;
use grainlab_console::Failure;
use grainlab_recordings::{ChannelInfo, Recording, Selection, TopicNames};
use std::slice::from_ref;

/// The messages that are wanted.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Excerpt {
    #[command(flatten)]
    topics: Topics,
    #[command(flatten)]
    interval: Interval,
}

impl Excerpt {
    /// Returns the topics of the recordings that are wanted, the first log time, and the one before which to end.
    pub(crate) fn find(
        &self,
        recordings: &[Recording],
    ) -> Result<(Topics, Option<u64>, Option<u64>), Failure> {
        let topics = self.topics.check(recordings)?;
        let (start, end) = self.interval.of(recordings)?;
        Ok((topics, start, end))
    }

    /// Selects the messages of a recording; the last is the channels wanted, where not all of a topic are.
    pub(crate) fn select(&self, recording: &Recording) -> Result<(Selection, Option<Topics>), Failure> {
        let (found, start, end) = self.find(from_ref(recording))?;
        let wanted = recording.all_channels().filter(|c| found.take(c));
        let topics = Some(wanted.map(|c| c.topic.clone()).collect());
        Ok((Selection { topics, start, end }, found.has_types().then_some(found)))
    }
}

/// Topics, by name, regular expression or type.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct Topics {
    #[command(flatten)]
    names: TopicNames,
    /// Topics to take, by type: sensor_msgs/msg/Imu
    #[arg(long, num_args = 1.., value_name = "TYPE")]
    types: Vec<String>,
}

fn bare(name: &str) -> &str {
    name.trim_start_matches('/')
}

impl Topics {
    pub(crate) fn is_given(&self) -> bool {
        !self.names.topics.is_empty() || self.names.regex.is_some() || !self.types.is_empty()
    }

    pub(crate) fn take(&self, channel: &ChannelInfo) -> bool {
        let short = channel.ros_type.replace("/msg/", "/");
        let is_one = |types: &[String]| types.iter().any(|t| *t == channel.ros_type || *t == short);
        let of_type = (!self.types.is_empty()).then(|| is_one(&self.types));
        self.names.take(&channel.topic, of_type, true)
    }

    /// True if a topic of several types may be wanted in part.
    pub(crate) fn has_types(&self) -> bool {
        !self.types.is_empty()
    }

    /// Errors if a name or type is in none of the recordings, or nothing is taken.
    pub(crate) fn check(&self, recordings: &[Recording]) -> Result<Self, Failure> {
        let channels: Vec<_> = recordings.iter().flat_map(Recording::all_channels).collect();
        let names = self.names.among(&channels.iter().map(|c| c.topic.as_str()).collect());
        let found = Self { names, types: self.types.clone() };
        let known = || {
            let mut names: Vec<&str> = channels.iter().map(|c| c.topic.as_str()).collect();
            names.sort_unstable();
            names.dedup();
            names.join(", ")
        };
        for name in self.names.topics.iter().chain(&self.names.exclude) {
            if !channels.iter().any(|c| bare(&c.topic) == bare(name)) {
                return Err(Failure::usage(format!("no topic {name} in the recording; it has: {}", known())));
            }
        }
        if channels.is_empty() || channels.iter().any(|c| found.take(c)) {
            return Ok(found);
        }
        Err(Failure::usage(format!("no topic is left; the recording has: {}", known())))
    }
}
