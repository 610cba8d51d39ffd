//! Exchanges of the lockstep that a recording has, by the numbers that requests and answers carry.

use grainlab_console::Failure;
use grainlab_msgs::msg::{StrainRate, Stress};
use grainlab_msgs::{Topic, topics};
use grainlab_recordings::{ChannelInfo, Message, Recording, Selection};

/// Numbers of the requests and of the answers in a recording.
#[derive(Debug, Default)]
pub struct Exchanges {
    stress: Vec<u64>,
    rates: Vec<u64>,
}

impl Exchanges {
    /// Those of all parts of a run that was resumed; `None` if requests and answers were not recorded.
    pub fn of(recording: &Recording) -> Result<Option<Self>, Failure> {
        let stress = |m: &Message| m.decoded::<Stress>().ok().map(|m| m.sequence);
        let rate = |m: &Message| m.decoded::<StrainRate>().ok().map(|m| m.sequence);
        let (stress, rates) = (
            numbers(recording, topics::STRESS.name, stress)?,
            numbers(recording, topics::STRAIN_RATE.name, rate)?,
        );
        Ok(stress.zip(rates).map(|(stress, rates)| Self { stress, rates }))
    }

    /// Number of answered requests, up to the last answer in the recording; those before it may be missing.
    pub fn count(&self) -> u64 {
        self.rates.last().map_or(0, |last| last + 1)
    }

    /// Missing messages of a finished run, one line per topic. Another engine went on with it `changes` times: the last request of
    /// the one before may have no answer.
    pub fn missing(&self, changes: usize) -> Vec<String> {
        let exchanges = self.stress.iter().chain(&self.rates).max().map_or(0, |last| last + 1);
        let line = |(topic, known, allowed): (&str, &[u64], usize)| {
            let lacking = (exchanges - known.len() as u64).saturating_sub(allowed as u64);
            (lacking > 0)
                .then(|| format!("{lacking} of {exchanges} messages of {topic} are not in the recording"))
        };
        let topics =
            [(topics::STRESS.name, &*self.stress, 0), (topics::STRAIN_RATE.name, &*self.rates, changes)];
        topics.into_iter().filter_map(line).collect()
    }
}

/// Distinct numbers of a topic's messages, sorted; `None` if the recording does not have the topic.
fn numbers(
    recording: &Recording,
    name: &str,
    number: impl Fn(&Message) -> Option<u64>,
) -> Result<Option<Vec<u64>>, Failure> {
    let channels = recording.channels();
    let is_wanted = |c: &&std::sync::Arc<ChannelInfo>| {
        Topic::of_channel(&c.topic, &c.ros_type).is_some_and(|t| t.name == name)
    };
    let of_topic: Vec<String> = channels.iter().filter(is_wanted).map(|c| c.topic.clone()).collect();
    if of_topic.is_empty() {
        return Ok(None);
    }
    let messages = recording.messages(&Selection::topics(of_topic))?;
    let mut numbers: Vec<u64> = messages.filter_map(|m| number(&m)).collect();
    numbers.sort_unstable();
    numbers.dedup();
    Ok(Some(numbers))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exchanges_that_are_not_in_the_recording_are_counted_and_named() {
        let exchanges = Exchanges { stress: vec![0, 1, 4, 5], rates: vec![0, 4] };
        assert_eq!(exchanges.count(), 5);
        let missing = exchanges.missing(0).join("\n");
        assert!(missing.contains("2 of 6 messages of stress") && missing.contains("4 of 6"), "{missing}");
    }
}
