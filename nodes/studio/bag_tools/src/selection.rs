//! Topics on the command line.

use grainlab_console::Failure;
use grainlab_recordings::{ChannelInfo, Recording, TopicNames};

/// Topics, by name, regular expression or type.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Topics {
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
    /// True if topics are asked for.
    pub(crate) fn is_given(&self) -> bool {
        !self.names.topics.is_empty() || self.names.regex.is_some() || !self.types.is_empty()
    }

    /// True for a channel that is wanted.
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

    /// The topics of these recordings that are wanted.
    ///
    /// # Errors
    /// If a name or type is in none of the recordings, or nothing is taken.
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
