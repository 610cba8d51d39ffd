//! The lockstep: one request, its repetitions, its answer.

use crate::Settings;
use grainlab_msgs::boundary::StrainRateAnswer;
use grainlab_msgs::builtin_interfaces::Time;
use std::time::Duration;

/// Refused answers in a row that end a run.
pub(crate) const REFUSALS_ALLOWED: u32 = 10;

/// The request under way, and the latest answer.
#[derive(Debug)]
pub(crate) struct Barrier {
    lag: u64,
    resend_after: Duration,
    resend_at_most: Duration,
    sequence: u64,
    stamp: Time,
    body: Vec<u8>,
    /// The request before: empty for the first one.
    previous: Vec<u8>,
    asked: Duration,
    /// Time since then that was not spent waiting.
    busy: Duration,
    resend_at: Duration,
    pause: Duration,
    answer: Option<(u64, [f64; 6])>,
    refused_in_row: u32,
    pub(crate) counts: Counts,
}

/// What happened at the barrier.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) exchanges: u64,
    pub(crate) resends: u64,
    pub(crate) refused: u64,
    pub(crate) stale: u64,
    pub(crate) waiting: Duration,
}

impl Barrier {
    pub(crate) fn new(settings: &Settings) -> Self {
        Self {
            lag: settings.mode.lag(),
            resend_after: settings.resend_after,
            resend_at_most: settings.resend_at_most.max(settings.resend_after),
            sequence: 0,
            stamp: Time::default(),
            body: Vec::new(),
            previous: Vec::new(),
            asked: Duration::ZERO,
            busy: Duration::ZERO,
            resend_at: Duration::ZERO,
            pause: Duration::ZERO,
            answer: None,
            refused_in_row: 0,
            counts: Counts::default(),
        }
    }

    /// The run begins: what was refused before does not count.
    pub(crate) fn begin(&mut self) {
        self.refused_in_row = 0;
    }

    /// A request has been published.
    pub(crate) fn ask(&mut self, sequence: u64, stamp: Time, body: Vec<u8>, now: Duration) {
        self.previous = std::mem::replace(&mut self.body, body);
        (self.sequence, self.stamp, self.asked, self.busy) = (sequence, stamp, now, Duration::ZERO);
        self.pause = self.resend_after;
        self.resend_at = now + self.pause;
    }

    /// The run was computed on for this long while the answer was on its way.
    pub(crate) fn computed(&mut self, time: Duration) {
        self.busy += time;
    }

    /// Takes an answer in; one to another request is counted and dropped.
    pub(crate) fn hear(&mut self, answer: &StrainRateAnswer) {
        let newer = self.answer.is_none_or(|(known, _)| known < answer.sequence);
        let ahead = self.sequence.checked_sub(answer.sequence).is_some_and(|behind| behind <= self.lag);
        // The stamp tells an answer to ours from one to another simulator's request of the same number.
        let ours = answer.sequence != self.sequence || answer.stamp == self.stamp;
        if newer && ahead && ours {
            self.answer = Some((answer.sequence, answer.rate));
            self.refused_in_row = 0;
        } else {
            self.counts.stale += 1;
        }
    }

    /// Counts a refused answer; the request is due again at once. True where the run must end.
    pub(crate) fn refuse(&mut self, now: Duration) -> bool {
        self.counts.refused += 1;
        self.refused_in_row += 1;
        self.resend_at = now;
        self.refused_in_row >= REFUSALS_ALLOWED
    }

    /// The rate to obey, if the run may go on.
    pub(crate) fn pass(&mut self, now: Duration) -> Option<[f64; 6]> {
        let (sequence, rate) = self.answer?;
        if sequence + self.lag < self.sequence {
            return None;
        }
        self.counts.exchanges += 1;
        self.counts.waiting += now.saturating_sub(self.asked + self.busy);
        Some(rate)
    }

    /// What to publish again, if the request under way is due again: the one before it, too. A servo that was killed may
    /// have handed its last answer to us and not to the recorder; the next servo says it again, in its place.
    pub(crate) fn resend(&mut self, now: Duration) -> Option<[&[u8]; 2]> {
        if now < self.resend_at {
            return None;
        }
        self.pause = (2 * self.pause).min(self.resend_at_most);
        self.resend_at = now + self.pause;
        self.counts.resends += 1;
        Some([&self.previous, &self.body])
    }

    /// Time until the request is due again.
    pub(crate) fn patience(&self, now: Duration) -> Duration {
        self.resend_at.saturating_sub(now)
    }

    /// Time for which the request has been without an answer.
    pub(crate) fn waited(&self, now: Duration) -> Duration {
        now.saturating_sub(self.asked)
    }

    /// The sequence of the request under way.
    pub(crate) fn sequence(&self) -> u64 {
        self.sequence
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mode;

    const MS: Duration = Duration::from_millis(1);

    fn barrier(mode: Mode) -> Barrier {
        let mut barrier = Barrier::new(&Settings { mode, ..Settings::default() });
        barrier.ask(7, Time { sec: 1, nanosec: 7 }, vec![7], Duration::ZERO);
        barrier
    }

    fn answer(sequence: u64, nanosec: u32) -> StrainRateAnswer {
        StrainRateAnswer {
            stamp: Time { sec: 1, nanosec },
            sequence,
            rate: [sequence as f64; 6],
            saturated: [false; 6],
        }
    }

    #[test]
    fn only_the_answer_to_this_very_request_passes() {
        let mut barrier = barrier(Mode::Lockstep);
        for stale in [answer(6, 6), answer(8, 8), answer(7, 6)] {
            barrier.hear(&stale);
            assert_eq!(barrier.pass(MS), None, "{stale:?}");
        }
        barrier.hear(&answer(7, 7));
        assert_eq!(barrier.pass(MS), Some([7.0; 6]));
        barrier.hear(&answer(7, 7));
        assert_eq!((barrier.counts.stale, barrier.counts.exchanges), (4, 1));
    }

    #[test]
    fn repetitions_grow_apart_up_to_the_longest_pause() {
        let mut barrier = barrier(Mode::Lockstep);
        let mut at = Vec::new();
        for t in 0..1000 {
            if barrier.resend(t * MS) == Some([&[], &[7]]) {
                at.push(t);
            }
        }
        assert_eq!(at, [20, 60, 140, 300, 500, 700, 900]);
    }

    #[test]
    fn ten_refusals_in_a_row_end_a_run_and_an_answer_between_them_does_not_let_them_add_up() {
        let mut barrier = barrier(Mode::Lockstep);
        assert!((1..REFUSALS_ALLOWED).all(|_| !barrier.refuse(MS)));
        assert_eq!(barrier.resend(MS), Some([&[][..], &[7]]), "a refused answer is asked for again at once");
        barrier.ask(8, Time::default(), vec![8], MS);
        assert_eq!(barrier.resend(100 * MS), Some([&[7][..], &[8]]), "with the request before it");
        barrier.ask(7, Time { sec: 1, nanosec: 7 }, vec![7], MS);
        barrier.hear(&answer(7, 7));
        assert!((1..REFUSALS_ALLOWED).all(|_| !barrier.refuse(MS)));
        assert!(barrier.refuse(MS));
    }

    #[test]
    fn free_run_uses_the_latest_answer_until_it_is_too_old() {
        let mut barrier = barrier(Mode::FreeRun { lag: 2 });
        assert_eq!(barrier.pass(MS), None, "there is nothing to obey before the first answer");
        barrier.hear(&answer(6, 6));
        barrier.hear(&answer(5, 5));
        assert_eq!(barrier.pass(MS), Some([6.0; 6]), "a late answer does not replace a newer one");
        for (sequence, passes) in [(8, true), (9, false)] {
            barrier.ask(sequence, Time::default(), vec![], MS);
            assert_eq!(barrier.pass(MS).is_some(), passes, "request {sequence}");
        }
    }
}
