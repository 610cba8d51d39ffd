//! The servo of the run.

use grainlab_msgs::Guid;
use grainlab_node_kit::{Participant, SampleInfo, member_of, run_of};
use std::collections::BTreeSet;

/// Maximum number of other servos that are logged.
const NAMED: usize = 64;

/// The servo of the run: the first one that answered, until it leaves.
#[derive(Debug)]
pub(crate) struct Partner {
    /// The writer of requests of this process.
    pub(crate) stress: Guid,
    current: Option<Participant>,
    named: BTreeSet<Participant>,
    /// Number of ignored answers of other servos.
    pub(crate) ignored: u64,
}

/// Source of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AnswerSource {
    /// The servo of the run, or one that replaces it.
    Ours,
    /// An answer to another simulator.
    AnotherRun,
    /// Another servo, while that of the run is present; `new` at its first answer.
    Another { new: bool },
}

/// True if two participants are the same process of a launched run, before and after a restart.
pub(crate) fn same_member(a: &Participant, b: &Participant) -> bool {
    run_of(a).is_some() && run_of(a) == run_of(b) && member_of(a) == member_of(b)
}

/// True if `b` is the restarted process of `a`. Only processes of a launcher have a member number (1 to 254); without
/// one, two simulators are always two processes.
pub(crate) fn predecessor(a: &Participant, b: &Participant) -> bool {
    same_member(a, b) && member_of(b) != 0
}

/// Writers that are different servos: a restarted one counts once.
pub(crate) fn different(writers: &[Guid]) -> Vec<Guid> {
    let mut found: Vec<Guid> = Vec::new();
    for writer in writers {
        let participant = writer.participant();
        let known = |w: &Guid| w.participant() == participant || same_member(&w.participant(), &participant);
        if !found.iter().any(known) {
            found.push(*writer);
        }
    }
    found
}

impl Partner {
    pub(crate) fn new(stress: Guid) -> Self {
        Self { stress, current: None, named: BTreeSet::new(), ignored: 0 }
    }

    /// The source of an answer; `present` returns the writers of answers in the graph.
    pub(crate) fn judge(&mut self, info: &SampleInfo, present: impl Fn() -> Vec<Guid>) -> AnswerSource {
        if info.about.is_some_and(|asked| asked.writer != self.stress) {
            return AnswerSource::AnotherRun;
        }
        let sender = info.writer.participant();
        let gone = |current: Participant| !present().iter().any(|w| w.participant() == current);
        if self.current.is_none_or(|c| c == sender || same_member(&c, &sender) || gone(c)) {
            return AnswerSource::Ours;
        }
        self.ignored += 1;
        AnswerSource::Another { new: self.named.len() < NAMED && self.named.insert(sender) }
    }

    /// Makes this the servo of the run; true if it replaces another one.
    pub(crate) fn stay_with(&mut self, writer: Guid) -> bool {
        let sender = writer.participant();
        self.current.replace(sender).is_some_and(|before| before != sender)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_node_kit::{Identity, RunId, SampleId};

    const STRESS: Guid = Guid([9; 16]);

    fn writer(prefix: Participant) -> Guid {
        let mut id = [1; 16];
        id[..12].copy_from_slice(&prefix);
        Guid(id)
    }

    fn answer(writer: Guid) -> SampleInfo {
        SampleInfo { writer, sequence: 1, source_time: None, received: 0, about: None }
    }

    #[test]
    fn the_run_stays_with_the_first_servo_until_that_one_is_gone() {
        let (first, second) = (writer([1; 12]), writer([2; 12]));
        let mut partner = Partner::new(STRESS);
        assert_eq!(partner.judge(&answer(first), || vec![first, second]), AnswerSource::Ours);
        assert!(!partner.stay_with(first));
        assert_eq!(
            partner.judge(&answer(second), || vec![first, second]),
            AnswerSource::Another { new: true }
        );
        assert_eq!(
            partner.judge(&answer(second), || vec![first, second]),
            AnswerSource::Another { new: false }
        );
        assert_eq!(partner.judge(&answer(first), || vec![first, second]), AnswerSource::Ours);
        assert_eq!(partner.judge(&answer(second), || vec![second]), AnswerSource::Ours);
        assert!(partner.stay_with(second));
        assert_eq!(partner.ignored, 2);
    }

    #[test]
    fn a_restarted_servo_takes_its_own_place_at_once() {
        let servo = Identity::member_of(RunId::named("a"), 4);
        let (before, after) = (writer(servo.guid_prefix()), writer(servo.guid_prefix()));
        let mut partner = Partner::new(STRESS);
        partner.stay_with(before);
        assert_eq!(partner.judge(&answer(after), || vec![before, after]), AnswerSource::Ours);
        assert_eq!(different(&[before, after]).len(), 1);
        assert_eq!(different(&[writer([1; 12]), writer([2; 12])]).len(), 2);
    }

    #[test]
    fn an_answer_to_another_simulator_is_of_another_run() {
        let servo = writer([1; 12]);
        let about = |writer| Some(SampleId { writer, sequence: 5 });
        let mut partner = Partner::new(STRESS);
        let elsewhere = SampleInfo { about: about(Guid([8; 16])), ..answer(servo) };
        assert_eq!(partner.judge(&elsewhere, || vec![servo]), AnswerSource::AnotherRun);
        let here = SampleInfo { about: about(STRESS), ..answer(servo) };
        assert_eq!(partner.judge(&here, || vec![servo]), AnswerSource::Ours);
    }
}
