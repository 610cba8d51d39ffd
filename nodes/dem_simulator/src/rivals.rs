//! Other simulators on the same topics.

use grainlab_node_kit::WriterId;
use std::collections::BTreeMap;
use std::time::Duration;

/// A rival that lives and has the larger GUID may have started at the same moment: it gets this long to give way.
const GRACE: Duration = Duration::from_secs(2);

/// A crashed process stays in the graph until its lease ends, within a minute. A rival that has said nothing for so long
/// and is still there is none of those.
const SILENCE: Duration = Duration::from_secs(75);

/// Rivals that are kept in mind: one is enough to refuse a run.
const KEPT: usize = 512;

type Participant = [u8; 12];

/// What is known of other writers of `stress`. A living simulator says where it stands (`run_state`, latched and once a
/// second); a writer that says nothing may be what a crash left behind.
#[derive(Debug)]
pub(crate) struct Rivals {
    own: Participant,
    seen: BTreeMap<Participant, Duration>,
    heard: BTreeMap<Participant, Duration>,
}

/// Whether a run may start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Nobody else is there.
    Clear,
    /// It is not known yet.
    Wait(WriterId),
    /// Another simulator was first.
    Refuse(WriterId),
}

impl Rivals {
    pub(crate) fn new(own: Participant) -> Self {
        Self { own, seen: BTreeMap::new(), heard: BTreeMap::new() }
    }

    /// A `run_state` of this writer has arrived. True the first time, if it is a rival's.
    pub(crate) fn hear(&mut self, writer: WriterId, now: Duration) -> bool {
        let participant = writer.participant();
        if self.heard.len() >= KEPT {
            return false;
        }
        participant != self.own && self.heard.insert(participant, now).is_none()
    }

    /// Judges the other writers of `stress` that are in the graph now.
    pub(crate) fn verdict(&mut self, foreign: &[WriterId], now: Duration) -> Verdict {
        let mut verdict = Verdict::Clear;
        for writer in foreign {
            let participant = writer.participant();
            let since = *self.seen.entry(participant).or_insert(now);
            let patience = match self.heard.get(&participant) {
                Some(_) if participant < self.own => Duration::ZERO,
                Some(_) => GRACE,
                None => SILENCE,
            };
            if now.saturating_sub(since) >= patience {
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

    fn writer(first: u8) -> WriterId {
        let mut id = [9; 16];
        id[0] = first;
        WriterId(id)
    }

    #[test]
    fn of_two_that_start_at_once_the_larger_guid_gives_way_and_the_smaller_starts() {
        let (small, large) = (writer(1), writer(2));
        let (mut first, mut second) = (Rivals::new(small.participant()), Rivals::new(large.participant()));
        assert!(first.hear(large, SECOND) && second.hear(small, SECOND));
        assert_eq!(second.verdict(&[small], SECOND), Verdict::Refuse(small));
        assert_eq!(first.verdict(&[large], SECOND), Verdict::Wait(large));
        assert_eq!(first.verdict(&[], 2 * SECOND), Verdict::Clear, "the other one is gone");
    }

    #[test]
    fn one_that_lives_and_does_not_give_way_was_first() {
        let (small, large) = (writer(1), writer(2));
        let mut rivals = Rivals::new(small.participant());
        rivals.hear(large, SECOND);
        assert_eq!(rivals.verdict(&[large], SECOND), Verdict::Wait(large));
        assert_eq!(rivals.verdict(&[large], SECOND + GRACE), Verdict::Refuse(large));
    }

    #[test]
    fn what_a_crash_left_behind_is_waited_out_and_never_taken_for_dead_while_it_is_there() {
        let dead = writer(1);
        let mut rivals = Rivals::new(writer(2).participant());
        assert_eq!(rivals.verdict(&[dead], SECOND), Verdict::Wait(dead));
        assert_eq!(rivals.verdict(&[dead], 60 * SECOND), Verdict::Wait(dead));
        assert_eq!(rivals.verdict(&[], 61 * SECOND), Verdict::Clear);
        assert_eq!(rivals.verdict(&[dead], SECOND + SILENCE), Verdict::Refuse(dead));
    }

    #[test]
    fn our_own_messages_are_no_rivals() {
        let own = writer(1);
        assert!(!Rivals::new(own.participant()).hear(own, SECOND));
    }
}
