//! The result of a launched run, with the stable keys of `summary.json`.

use crate::inference::Inference;
use crate::read_back::{EngineRange, InvertedPacking, ReadBack, WithinPhases};
use grainlab_msgs::{Exit, Report};
use grainlab_recordings::TopicTally;
use grainlab_recordings::strangers::StrangerView;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A launched run.
#[derive(Debug, Serialize)]
pub struct Summary {
    #[serde(flatten)]
    pub(crate) launched: Launched,
    pub(crate) strangers: Vec<StrangerView>,
    pub(crate) topics: Vec<TopicCount>,
    pub(crate) exchanges_per_second: Option<f64>,
    /// Fraction of the run's time that the simulator waited for answers.
    pub(crate) waiting_fraction: Option<f64>,
    pub(crate) particle_steps_per_second: Option<f64>,
    /// Engines of the packings, if another one than ours made any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) engines: Vec<EngineRange>,
    /// Packings at the ends of phases, with what was inferred.
    pub states: Vec<InvertedPacking>,
    /// Inferred from data that are not about a packing of the run.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) of_instruments: Vec<Inference>,
    pub(crate) within_phases: WithinPhases,
    /// Step of the last packing in the recording, from which a run that is not finished goes on.
    pub(crate) saved_step: Option<u64>,
    /// Why the exit code is not 0, if it is known.
    #[serde(skip)]
    pub(crate) reason: Option<String>,
    /// Why the run did not end as it should, and what is missing or could not be read, one line each.
    pub(crate) warnings: Vec<String>,
}

/// One node of a run.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(default)]
pub struct NodeEnd {
    /// Name of the node.
    pub name: String,
    /// Process id of its last process.
    pub pid: u32,
    /// Exit code; null if a signal ended it.
    pub exit: Option<i32>,
    /// Number of times that it was started again.
    pub restarts: usize,
}

/// Messages of one topic.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(default)]
pub struct TopicCount {
    /// Name of the topic.
    pub name: String,
    /// All that were published: the sum of the others.
    pub published: u64,
    /// In the recording.
    pub recorded: u64,
    /// Published, and not received.
    pub lost: u64,
    /// Received again from a restarted process.
    pub repeated: u64,
    /// Left out because others are recorded in their place, if any are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) conflicting: Option<u64>,
}

impl TopicCount {
    /// Combines the counts of the recorders with the messages in the files. A killed recorder left no counts, and a file that was
    /// damaged after its messages were counted has lost some of them.
    fn of(tallies: &[TopicTally], recorded: &BTreeMap<String, u64>) -> Vec<Self> {
        let count = |t: &TopicTally| {
            let there = recorded.get(&t.name).copied().unwrap_or(0);
            Self {
                name: t.name.clone(),
                published: t.published + there.saturating_sub(t.recorded),
                recorded: there,
                lost: t.lost + t.recorded.saturating_sub(there),
                repeated: t.repeated,
                conflicting: Some(t.conflicting).filter(|n| *n > 0),
            }
        };
        tallies.iter().map(count).collect()
    }
}

impl Summary {
    /// Combines the data of the launcher with those of the recording.
    pub fn new(launched: Launched, back: ReadBack, tallies: Option<&[TopicTally]>) -> Self {
        let has_counters = |r: &&Report| r.health.value("particle_steps_per_s").is_some();
        let simulator = back.reports.values().rfind(has_counters);
        let number = |key: &str| simulator?.health.value(key)?.parse::<f64>().ok().filter(|v| v.is_finite());
        let wall = number("wall_s").filter(|s| *s > 0.0);
        let per_wall = |key: &str| Some(number(key)? / wall?);
        let warnings: Vec<String> = launched.reasons.iter().cloned().chain(back.complaints).collect();
        // The launcher may have no reason for missing results and moduli; the recording has.
        let is_of_recording = [Exit::DataLoss, Exit::PhysicsInvalid].map(Exit::code).contains(&launched.exit);
        let reason = launched.reasons.first().or(warnings.first().filter(|_| is_of_recording)).cloned();
        Self {
            strangers: back.strangers,
            topics: TopicCount::of(tallies.unwrap_or_default(), &launched.recorded),
            exchanges_per_second: per_wall("exchanges"),
            waiting_fraction: per_wall("waiting_s"),
            particle_steps_per_second: number("particle_steps_per_s"),
            engines: back.engines,
            states: back.states,
            of_instruments: back.of_instruments,
            within_phases: back.within_phases,
            saved_step: back.saved_step,
            reason,
            warnings,
            launched,
        }
    }
}

/// The data that the launcher has of a run.
#[derive(Debug, Default, Serialize)]
pub struct Launched {
    /// Name of the scene.
    pub scene: String,
    /// Seed of the scene.
    pub seed: u64,
    /// Number of the DDS domain.
    pub domain: Option<u16>,
    /// Id of the run.
    pub run: String,
    /// The run was resumed: times and rates are those of its last part, and counts those of the whole run.
    pub resumed: bool,
    /// From the first start of a process to the last end, s.
    pub wall_seconds: f64,
    /// Every process of the run.
    pub nodes: Vec<NodeEnd>,
    /// Files whose recorder ended early, because it was killed or the disk was full: the counts of lost messages are without theirs.
    pub uncounted_files: usize,
    /// Exchanges in the recording, of the whole run.
    pub exchanges: Option<u64>,
    /// The directory of the recording; `None` if it cannot be read.
    pub recording: Option<String>,
    /// Exit code of the run.
    pub exit: u8,
    /// Messages in the recording, by topic.
    #[serde(skip)]
    pub recorded: BTreeMap<String, u64>,
    /// Why it did not end as it should, one line each.
    #[serde(skip)]
    pub reasons: Vec<String>,
}

#[cfg(test)]
impl Summary {
    pub(crate) fn of_nothing(exit: Exit) -> Self {
        Self::new(Launched { exit: exit.code(), ..Launched::default() }, ReadBack::default(), None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_that_was_recorded_and_is_not_in_the_file_counts_as_lost() {
        let tally = TopicTally {
            name: "/stress".to_owned(),
            published: 12,
            recorded: 10,
            lost: 1,
            repeated: 1,
            conflicting: 0,
            redelivered: 0,
            writers: Vec::new(),
        };
        let of = |there| {
            let count =
                &TopicCount::of(std::slice::from_ref(&tally), &[("/stress".to_owned(), there)].into())[0];
            (count.published, count.recorded, count.lost, count.repeated)
        };
        assert_eq!(of(10), (12, 10, 1, 1));
        assert_eq!(of(7), (12, 7, 4, 1), "the file was damaged");
        assert_eq!(of(15), (17, 15, 1, 1), "a killed recorder did not count its file");
    }
}
