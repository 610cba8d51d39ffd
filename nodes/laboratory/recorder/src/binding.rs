//! Selects the messages of a run whose processes were started by hand and have no common run id.
//!
//! The run is that of the first simulator that publishes. Its id is the participant of that simulator: answers and
//! results refer to its samples (see `SampleInfo::about`).

use grainlab_msgs::{Guid, Topic, topics};
use grainlab_node_kit::{Participant, SampleInfo};
use std::collections::BTreeMap;

/// Maximum number of participants counted separately.
const MAX_COUNTED: usize = 64;

/// Topics that only the simulator publishes.
const OF_SIMULATOR: [Topic; 5] =
    [topics::STRESS, topics::PACKING, topics::RUN_STATE, topics::CLOCK, topics::TF_STATIC];

/// Topics of which all messages are recorded: they are about processes, not about the run.
const OF_ANYONE: [Topic; 2] = [topics::DIAGNOSTICS, topics::ROSOUT];

fn is_among(topic: &Topic, list: &[Topic]) -> bool {
    list.iter().any(|t| t.name == topic.name)
}

/// Why a message is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outside {
    /// It comes from another simulator, or refers to no sample of this one.
    Stranger,
    /// It refers to this run, but another present process publishes the same kind of message.
    Second,
}

/// The run that a recorder started by hand is bound to.
#[derive(Debug, Default)]
pub(crate) struct Binding {
    /// The simulators of the run: the last one is running, earlier ones have ended.
    simulators: Vec<Participant>,
    /// The writer of each kind of answer and result.
    authors: BTreeMap<&'static str, Participant>,
    ignored: BTreeMap<Participant, BTreeMap<&'static str, u64>>,
}

impl Binding {
    /// Decides if a message belongs to the run; `present` lists the present writers of a topic.
    pub(crate) fn takes(
        &mut self,
        topic: &Topic,
        info: &SampleInfo,
        present: impl Fn(&Topic) -> Vec<Guid>,
    ) -> Result<(), Outside> {
        let verdict = self.judge(topic, info, present);
        if verdict.is_err() {
            let participant = info.writer.participant();
            if self.ignored.len() < MAX_COUNTED || self.ignored.contains_key(&participant) {
                *self.ignored.entry(participant).or_default().entry(topic.name).or_default() += 1;
            }
        }
        verdict
    }

    fn judge(
        &mut self,
        topic: &Topic,
        info: &SampleInfo,
        present: impl Fn(&Topic) -> Vec<Guid>,
    ) -> Result<(), Outside> {
        let participant = info.writer.participant();
        let there = |topic: &Topic, who: Participant| present(topic).iter().any(|w| w.participant() == who);
        if is_among(topic, &OF_ANYONE) {
            return Ok(());
        }
        if is_among(topic, &OF_SIMULATOR) {
            return match self.simulators.last() {
                Some(known) if *known == participant => Ok(()),
                Some(known) if there(&topics::STRESS, *known) => Err(Outside::Stranger),
                _ => {
                    self.simulators.push(participant);
                    Ok(())
                }
            };
        }
        if !info.about.is_some_and(|about| self.simulators.contains(&about.writer.participant())) {
            return Err(Outside::Stranger);
        }
        match self.authors.get(topic.name) {
            Some(known) if *known == participant => Ok(()),
            Some(known) if there(topic, *known) => Err(Outside::Second),
            _ => {
                self.authors.insert(topic.name, participant);
                Ok(())
            }
        }
    }

    pub(crate) fn ignored(&self) -> &BTreeMap<Participant, BTreeMap<&'static str, u64>> {
        &self.ignored
    }

    /// The participant of the simulator, which is the id of the run.
    pub(crate) fn run(&self) -> Option<Participant> {
        self.simulators.first().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_node_kit::SampleId;

    fn info(who: u8, about: Option<u8>) -> SampleInfo {
        let about = about.map(|writer| SampleId { writer: Guid([writer; 16]), sequence: 1 });
        SampleInfo { writer: Guid([who; 16]), sequence: 1, source_time: None, received: 0, about }
    }

    #[test]
    fn the_first_simulator_is_the_run_and_results_have_to_be_about_it() {
        let everyone = |_: &Topic| vec![Guid([1; 16]), Guid([2; 16]), Guid([3; 16])];
        let mut binding = Binding::default();
        let mut takes = |topic, who, about| binding.takes(&topic, &info(who, about), everyone);
        assert_eq!(takes(topics::MODULI, 3, Some(1)), Err(Outside::Stranger), "there is no run yet");
        assert_eq!(takes(topics::STRESS, 1, None), Ok(()));
        assert_eq!(takes(topics::PACKING, 2, None), Err(Outside::Stranger));
        assert_eq!(takes(topics::MODULI, 3, Some(1)), Ok(()));
        assert_eq!(takes(topics::MODULI, 3, Some(2)), Err(Outside::Stranger), "about another packing");
        assert_eq!(takes(topics::MODULI, 2, None), Err(Outside::Stranger), "about nothing");
        assert_eq!(takes(topics::MODULI, 2, Some(1)), Err(Outside::Second));
        assert_eq!(takes(topics::DIAGNOSTICS, 2, None), Ok(()));
        assert_eq!(binding.ignored()[&[2; 12]]["moduli"], 2);
    }

    #[test]
    fn a_writer_that_left_is_replaced() {
        let alone = |_: &Topic| vec![Guid([2; 16]), Guid([4; 16])];
        let mut binding = Binding::default();
        let mut takes = |topic, who, about| binding.takes(&topic, &info(who, about), alone);
        assert_eq!(takes(topics::STRESS, 1, None), Ok(()));
        assert_eq!(takes(topics::STRESS, 2, None), Ok(()), "the first one is gone");
        assert_eq!(
            takes(topics::STRAIN_RATE, 3, Some(1)),
            Ok(()),
            "an answer to the first one belongs to this run, too"
        );
        assert_eq!(takes(topics::STRAIN_RATE, 4, Some(2)), Ok(()), "and so is its successor's");
    }
}
