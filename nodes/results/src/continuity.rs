//! Whether every exchange of the lockstep is in a recording, by the numbers that requests and answers carry.

use grainlab_msgs::msg::{StrainRate, Stress};
use grainlab_msgs::topics;
use grainlab_recordings::{Message, ReadError, Recording, Selection};

/// Missing messages of a finished run, one line per topic.
pub fn missing(recording: &Recording) -> Result<Vec<String>, ReadError> {
    let stress = numbers(recording, topics::STRESS.name, |m| m.decoded::<Stress>().ok().map(|m| m.sequence))?;
    let rates =
        numbers(recording, topics::STRAIN_RATE.name, |m| m.decoded::<StrainRate>().ok().map(|m| m.sequence))?;
    let exchanges = stress.iter().chain(&rates).max().map_or(0, |last| last + 1);
    let line = |(topic, known): (&str, &[u64])| {
        let lacking = exchanges - known.len() as u64;
        (lacking > 0)
            .then(|| format!("{lacking} of {exchanges} messages of {topic} are not in the recording"))
    };
    let topics = [(topics::STRESS.name, stress.as_slice()), (topics::STRAIN_RATE.name, rates.as_slice())];
    Ok(topics.into_iter().filter_map(line).collect())
}

/// Distinct numbers of a topic's messages, sorted.
fn numbers(
    recording: &Recording,
    name: &str,
    number: impl Fn(&Message) -> Option<u64>,
) -> Result<Vec<u64>, ReadError> {
    let channels = recording.channels();
    let of_topic =
        channels.iter().filter(|c| c.topic.rsplit('/').next() == Some(name)).map(|c| c.topic.clone());
    let messages = recording.messages(&Selection::topics(of_topic))?;
    let mut numbers: Vec<u64> = messages.filter_map(|m| number(&m)).collect();
    numbers.sort_unstable();
    numbers.dedup();
    Ok(numbers)
}
