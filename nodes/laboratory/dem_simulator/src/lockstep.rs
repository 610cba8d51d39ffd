//! The lockstep: one request, its repetitions and its answer.

use crate::Settings;
use grainlab_msgs::msg::StrainRate;
use grainlab_msgs::stamp;
use grainlab_servo::ServoRequest;
use std::time::Duration;

/// Number of consecutive invalid answers that ends a run.
pub(crate) const REFUSALS_ALLOWED: u32 = 10;

/// The current request and the latest answer.
#[derive(Debug, Default)]
pub(crate) struct Lockstep {
    resend_after: Duration,
    resend_at_most: Duration,
    /// The current request; `None` before the first one.
    request: Option<ServoRequest>,
    body: Vec<u8>,
    /// The previous request; empty for the first one.
    previous: Vec<u8>,
    asked: Duration,
    /// Time since then that was spent computing.
    busy: Duration,
    resend_at: Duration,
    pause: Duration,
    /// The first answer to it.
    answer: Option<[f64; 6]>,
    refused_in_row: u32,
    pub(crate) counts: Counts,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) exchanges: u64,
    pub(crate) resends: u64,
    pub(crate) refused: u64,
    /// Answers to requests that are not current.
    pub(crate) stale: u64,
    /// Answers that differ from an earlier answer to the same request.
    pub(crate) contradictions: u64,
    pub(crate) waiting: Duration,
}

/// Kind of a valid answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AnswerKind {
    /// The first answer to its request.
    New,
    /// An answer to a request that is not current, or a repetition.
    Stale,
    /// An answer that differs from an earlier one to the same request.
    Contradicts,
}

impl Lockstep {
    pub(crate) fn new(settings: &Settings) -> Self {
        Self {
            resend_after: settings.resend_after,
            resend_at_most: settings.resend_at_most.max(settings.resend_after),
            ..Self::default()
        }
    }

    /// A request has been published.
    pub(crate) fn ask(&mut self, request: &ServoRequest, body: Vec<u8>, now: Duration) {
        (self.request, self.answer) = (Some(*request), None);
        self.previous = std::mem::replace(&mut self.body, body);
        (self.asked, self.busy) = (now, Duration::ZERO);
        self.pause = self.resend_after;
        self.resend_at = now + self.pause;
    }

    /// Records the time spent computing while the answer was in transit.
    pub(crate) fn computed(&mut self, time: Duration) {
        self.busy += time;
    }

    /// Receives an answer. It is accepted if its sequence number is that of the current request, and invalid with another stamp
    /// or rates that the request does not allow.
    pub(crate) fn receive(&mut self, answer: &StrainRate) -> Result<AnswerKind, String> {
        let Some(request) = self.request.filter(|request| request.sequence == answer.sequence) else {
            self.counts.stale += 1;
            return Ok(AnswerKind::Stale);
        };
        let asked = stamp(request.time);
        if asked != answer.header.stamp {
            let [own, of_answer] =
                [asked, answer.header.stamp].map(|t| format!("{}.{:09} s", t.sec, t.nanosec));
            return Err(format!(
                "its stamp is {of_answer}, that of its request {own}: an answer has the header of its request"
            ));
        }
        if let Some(known) = self.answer {
            let same = known.map(f64::to_bits) == answer.rate.map(f64::to_bits);
            let (count, kind) = match same {
                true => (&mut self.counts.stale, AnswerKind::Stale),
                false => (&mut self.counts.contradictions, AnswerKind::Contradicts),
            };
            *count += 1;
            return Ok(kind);
        }
        request.input.allows(&answer.rate).map_err(|e| e.to_string())?;
        self.answer = Some(answer.rate);
        self.refused_in_row = 0;
        Ok(AnswerKind::New)
    }

    /// Counts an invalid answer; the request is repeated at once. True if the run must end.
    pub(crate) fn refuse(&mut self, now: Duration) -> bool {
        self.counts.refused += 1;
        self.refused_in_row += 1;
        self.resend_at = now;
        self.refused_in_row >= REFUSALS_ALLOWED
    }

    /// The rate to apply, if the run may continue.
    pub(crate) fn pass(&mut self, now: Duration) -> Option<[f64; 6]> {
        let rate = self.answer?;
        self.counts.exchanges += 1;
        self.counts.waiting += now.saturating_sub(self.asked + self.busy);
        Some(rate)
    }

    /// Takes back a rate that was not applied: its computation was stopped.
    pub(crate) fn not_applied(&mut self) {
        self.counts.exchanges = self.counts.exchanges.saturating_sub(1);
    }

    /// The messages to publish again, if the current request is due: with the previous one, since a servo that was
    /// killed may have delivered its last answer to the simulator and not to the recorder. The next servo repeats that
    /// answer.
    pub(crate) fn resend(&mut self, now: Duration) -> Option<[&[u8]; 2]> {
        if now < self.resend_at {
            return None;
        }
        self.pause = (2 * self.pause).min(self.resend_at_most);
        self.resend_at = now + self.pause;
        self.counts.resends += 1;
        Some([&self.previous, &self.body])
    }

    /// Time until the request is repeated.
    pub(crate) fn patience(&self, now: Duration) -> Duration {
        self.resend_at.saturating_sub(now)
    }

    /// Time since the request was published.
    pub(crate) fn waited(&self, now: Duration) -> Duration {
        now.saturating_sub(self.asked)
    }

    /// True from the first request on.
    pub(crate) fn has_asked(&self) -> bool {
        self.request.is_some()
    }

    /// The current request.
    pub(crate) fn body(&self) -> &[u8] {
        &self.body
    }

    /// Sequence number of the current request.
    pub(crate) fn sequence(&self) -> u64 {
        self.request.map_or(0, |request| request.sequence)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::{ComponentControl, ServoLaw, SymTensor};
    use grainlab_msgs::std_msgs::Header;
    use grainlab_servo::ServoInput;

    const MS: Duration = Duration::from_millis(1);

    fn request(sequence: u64) -> ServoRequest {
        ServoRequest {
            sequence,
            step: 0,
            phase: 1,
            time: time(sequence),
            input: ServoInput {
                stress: SymTensor::default(),
                controls: [ComponentControl::Stress(1e3); 6],
                rate: [0.0; 6],
                rate_limit: 100.0,
                law: ServoLaw::Scaled { response_time: 1.0 },
                tangent: None,
                control_interval: 1e-6,
            },
            asymmetry: 0.0,
            strain: SymTensor::default(),
            solid_fraction: 0.6,
            coordination: 6.0,
            unbalanced: 0.0,
        }
    }

    /// The simulated time of a request, s.
    fn time(sequence: u64) -> f64 {
        1e-9 * sequence as f64
    }

    fn lockstep() -> Lockstep {
        let mut lockstep = Lockstep::new(&Settings::default());
        lockstep.ask(&request(7), vec![7], Duration::ZERO);
        lockstep
    }

    fn answer(sequence: u64, asked: u64) -> StrainRate {
        let header = Header { stamp: stamp(time(asked)), ..Header::default() };
        StrainRate { header, sequence, rate: [sequence as f64; 6], saturated: [false; 6] }
    }

    #[test]
    fn only_the_answer_to_this_very_request_passes() {
        let mut lockstep = lockstep();
        for stale in [answer(6, 6), answer(8, 8)] {
            assert_eq!(lockstep.receive(&stale), Ok(AnswerKind::Stale));
            assert_eq!(lockstep.pass(MS), None, "{stale:?}");
        }
        assert!(lockstep.receive(&answer(7, 6)).unwrap_err().contains("the header of its request"));
        assert_eq!(lockstep.receive(&answer(7, 7)), Ok(AnswerKind::New));
        assert_eq!(lockstep.pass(MS), Some([7.0; 6]));
        assert_eq!(lockstep.receive(&answer(7, 7)), Ok(AnswerKind::Stale));
        assert_eq!((lockstep.counts.stale, lockstep.counts.exchanges), (3, 1));
    }

    #[test]
    fn an_answer_received_before_the_first_request_is_ignored() {
        let mut lockstep = Lockstep::new(&Settings::default());
        assert_eq!(lockstep.receive(&answer(0, 0)), Ok(AnswerKind::Stale));
        lockstep.ask(&request(0), vec![0], MS);
        assert_eq!(lockstep.pass(MS), None);
    }

    #[test]
    fn another_rate_for_the_same_request_is_a_contradiction_and_changes_nothing() {
        let mut lockstep = lockstep();
        assert_eq!(lockstep.receive(&answer(7, 7)), Ok(AnswerKind::New));
        let other = StrainRate { rate: [1.0; 6], ..answer(7, 7) };
        assert_eq!(lockstep.receive(&other), Ok(AnswerKind::Contradicts));
        assert_eq!((lockstep.pass(MS), lockstep.counts.contradictions), (Some([7.0; 6]), 1));
    }

    #[test]
    fn an_answer_beyond_the_rate_limit_is_refused() {
        let mut lockstep = lockstep();
        let fast = StrainRate { rate: [101.0; 6], ..answer(7, 7) };
        assert!(lockstep.receive(&fast).is_err());
        assert_eq!(lockstep.pass(MS), None);
    }

    #[test]
    fn repetitions_grow_apart_up_to_the_longest_pause() {
        let mut lockstep = lockstep();
        let mut at = Vec::new();
        for t in 0..1000 {
            if lockstep.resend(t * MS) == Some([&[], &[7]]) {
                at.push(t);
            }
        }
        assert_eq!(at, [20, 60, 140, 300, 500, 700, 900]);
    }

    #[test]
    fn ten_refusals_in_a_row_end_a_run_and_an_answer_between_them_does_not_let_them_add_up() {
        let mut lockstep = lockstep();
        assert!((1..REFUSALS_ALLOWED).all(|_| !lockstep.refuse(MS)));
        assert_eq!(lockstep.resend(MS), Some([&[][..], &[7]]), "a refused answer is asked for again at once");
        lockstep.ask(&request(8), vec![8], MS);
        assert_eq!(lockstep.resend(100 * MS), Some([&[7][..], &[8]]), "with the request before it");
        lockstep.ask(&request(9), vec![9], MS);
        assert_eq!(lockstep.receive(&answer(9, 9)), Ok(AnswerKind::New));
        assert!((1..REFUSALS_ALLOWED).all(|_| !lockstep.refuse(MS)));
        assert!(lockstep.refuse(MS));
    }
}
