//! A time limit that counts only while this process runs.

use std::time::{Duration, Instant};

/// A longer interval between two calls is not fully counted: the launcher itself was stopped meanwhile.
const STEP: Duration = Duration::from_millis(500);

/// The remaining time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TimeLimit {
    left: Duration,
    looked: Instant,
}

impl TimeLimit {
    pub(crate) fn new(time: Duration) -> Self {
        Self { left: time, looked: Instant::now() }
    }

    /// True when the time is over; call it several times a second. Time with `suspended` does not count.
    pub(crate) fn is_over(&mut self, suspended: bool) -> bool {
        self.passes(Instant::now(), suspended)
    }

    fn passes(&mut self, now: Instant, suspended: bool) -> bool {
        let step = now.saturating_duration_since(self.looked).min(STEP);
        self.looked = now;
        if !suspended {
            self.left = self.left.saturating_sub(step);
        }
        self.left.is_zero()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_for_which_somebody_was_stopped_does_not_count() {
        let begin = Instant::now();
        let at = |ms| begin + Duration::from_millis(ms);
        let mut limit = TimeLimit { left: Duration::from_secs(1), looked: begin };
        assert!(!limit.passes(at(60_000), false), "the launcher was stopped: one step counts");
        assert!(!limit.passes(at(60_400), true), "a process of the run was stopped");
        assert!(!limit.passes(at(60_800), false));
        assert!(limit.passes(at(61_000), false));
    }
}
