//! Other simulators on the same topics.

use grainlab_msgs::Guid;
use std::collections::BTreeMap;
use std::time::Duration;

/// A running simulator with the larger GUID may have started at the same moment: time for it to end.
const GRACE: Duration = Duration::from_secs(2);

/// A crashed process stays in the graph until its lease ends, within a minute. A writer that has published nothing for
/// this long and is still in the graph has not crashed.
const SILENCE: Duration = Duration::from_secs(75);

/// Maximum number of other simulators that are stored: one suffices to refuse a run.
const KEPT: usize = 512;

type Participant = [u8; 12];

/// Other writers of `stress`. A running simulator publishes `run_state` (latched, and once a second); a silent writer
/// may be left from a crash.
#[derive(Debug)]
pub(crate) struct DuplicateSimulators {
    own: Participant,
    seen: BTreeMap<Participant, Duration>,
    running: BTreeMap<Participant, Duration>,
}

/// Verdict on the start of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// There is no other writer.
    Clear,
    /// It is not yet determined whether this writer is a simulator.
    Wait(Guid),
    /// Another simulator started earlier.
    Refuse(Guid),
}

impl DuplicateSimulators {
    pub(crate) fn new(own: Participant) -> Self {
        Self { own, seen: BTreeMap::new(), running: BTreeMap::new() }
    }

    /// Records a `run_state` of this writer. True the first time for each other simulator.
    pub(crate) fn note_state(&mut self, writer: Guid, now: Duration) -> bool {
        let participant = writer.participant();
        if self.running.len() >= KEPT {
            return false;
        }
        participant != self.own && self.running.insert(participant, now).is_none()
    }

    /// Evaluates the other writers of `stress` that are in the graph.
    pub(crate) fn verdict(&mut self, foreign: &[Guid], now: Duration) -> Verdict {
        let mut verdict = Verdict::Clear;
        for writer in foreign {
            let participant = writer.participant();
            let since = *self.seen.entry(participant).or_insert(now);
            let time = match self.running.get(&participant) {
                Some(_) if participant < self.own => Duration::ZERO,
                Some(_) => GRACE,
                None => SILENCE,
            };
            if now.saturating_sub(since) >= time {
                return Verdict::Refuse(*writer);
            }
            verdict = Verdict::Wait(*writer);
        }
        verdict
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    fn writer(first: u8) -> Guid {
        let mut id = [9; 16];
        id[0] = first;
        Guid(id)
    }

    #[test]
    fn of_two_that_start_at_once_the_larger_guid_gives_way_and_the_smaller_starts() {
        let (small, large) = (writer(1), writer(2));
        let (mut first, mut second) =
            (DuplicateSimulators::new(small.participant()), DuplicateSimulators::new(large.participant()));
        assert!(first.note_state(large, SECOND) && second.note_state(small, SECOND));
        assert_eq!(second.verdict(&[small], SECOND), Verdict::Refuse(small));
        assert_eq!(first.verdict(&[large], SECOND), Verdict::Wait(large));
        assert_eq!(first.verdict(&[], 2 * SECOND), Verdict::Clear, "the other one is gone");
    }

    #[test]
    fn a_running_simulator_that_does_not_end_was_first() {
        let (small, large) = (writer(1), writer(2));
        let mut duplicates = DuplicateSimulators::new(small.participant());
        duplicates.note_state(large, SECOND);
        assert_eq!(duplicates.verdict(&[large], SECOND), Verdict::Wait(large));
        assert_eq!(duplicates.verdict(&[large], SECOND + GRACE), Verdict::Refuse(large));
    }

    #[test]
    fn a_silent_writer_is_waited_for_until_its_lease_has_ended() {
        let silent = writer(1);
        let mut duplicates = DuplicateSimulators::new(writer(2).participant());
        assert_eq!(duplicates.verdict(&[silent], SECOND), Verdict::Wait(silent));
        assert_eq!(duplicates.verdict(&[silent], 60 * SECOND), Verdict::Wait(silent));
        assert_eq!(duplicates.verdict(&[], 61 * SECOND), Verdict::Clear);
        assert_eq!(duplicates.verdict(&[silent], SECOND + SILENCE), Verdict::Refuse(silent));
    }

    #[test]
    fn our_own_messages_are_not_those_of_a_duplicate() {
        let own = writer(1);
        assert!(!DuplicateSimulators::new(own.participant()).note_state(own, SECOND));
    }
}
