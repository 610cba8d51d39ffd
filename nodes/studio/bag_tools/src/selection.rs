//! Topics on the command line.

use grainlab_console::Failure;
use grainlab_recordings::{ChannelInfo, Recording};
use regex_lite::Regex;

/// An expression that matches whole names only: the longest match may be another alternative than the first one.
fn whole(text: &str) -> Result<Regex, regex_lite::Error> {
    Regex::new(&format!("^(?:{text})$"))
}

/// Topics, by name, regular expression or type.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Topics {
    /// Topics to take, by name [default: all]
    #[arg(long, num_args = 1.., value_name = "TOPIC")]
    topics: Vec<String>,
    /// Topics to take, by a regular expression that matches their whole name
    #[arg(long, value_name = "REGEX", value_parser = whole)]
    regex: Option<Regex>,
    /// Topics to take, by type: sensor_msgs/msg/Imu
    #[arg(long, num_args = 1.., value_name = "TYPE")]
    types: Vec<String>,
    /// Topics to leave out of those, by name
    #[arg(long, num_args = 1.., value_name = "TOPIC")]
    exclude: Vec<String>,
    /// Topics to leave out of those, by a regular expression that matches their whole name
    #[arg(long, value_name = "REGEX", value_parser = whole)]
    exclude_regex: Option<Regex>,
}

fn bare(name: &str) -> &str {
    name.trim_start_matches('/')
}

impl Topics {
    /// True for a channel that is wanted.
    pub(crate) fn take(&self, channel: &ChannelInfo) -> bool {
        let name = channel.topic.as_str();
        let is_one = |names: &[String]| names.iter().any(|n| bare(n) == bare(name));
        let of_type = |types: &[String]| {
            let short = channel.ros_type.replace("/msg/", "/");
            types.iter().any(|t| *t == channel.ros_type || *t == short)
        };
        let all = self.topics.is_empty() && self.regex.is_none() && self.types.is_empty();
        let taken = all
            || is_one(&self.topics)
            || self.regex.as_ref().is_some_and(|r| r.is_match(name))
            || of_type(&self.types);
        taken && !is_one(&self.exclude) && !self.exclude_regex.as_ref().is_some_and(|r| r.is_match(name))
    }

    /// An error if a name or type is in none of the recordings, or nothing is taken.
    pub(crate) fn check(&self, recordings: &[Recording]) -> Result<(), Failure> {
        let channels: Vec<_> = recordings.iter().flat_map(Recording::channels).collect();
        let known = || {
            let mut names: Vec<&str> = channels.iter().map(|c| c.topic.as_str()).collect();
            names.sort_unstable();
            names.dedup();
            names.join(", ")
        };
        for name in self.topics.iter().chain(&self.exclude) {
            if !channels.iter().any(|c| bare(&c.topic) == bare(name)) {
                return Err(Failure::usage(format!("no topic {name} in the recording; it has: {}", known())));
            }
        }
        if channels.is_empty() || channels.iter().any(|c| self.take(c)) {
            return Ok(());
        }
        Err(Failure::usage(format!("no topic is left; the recording has: {}", known())))
    }
}
