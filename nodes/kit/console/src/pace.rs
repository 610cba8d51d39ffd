//! Rate of growth of a quantity, by the wall clock of the reader.

use std::collections::VecDeque;
use std::time::Duration;

/// Values that are kept, however fast they come.
const KEPT: usize = 512;

/// A quantity that grows, over the last seconds.
#[derive(Clone, Debug, Default)]
pub struct Pace<const SECONDS: u64> {
    values: VecDeque<(Duration, f64)>,
}

impl<const SECONDS: u64> Pace<SECONDS> {
    const WINDOW: Duration = Duration::from_secs(SECONDS);

    /// Adds a value at a time. One that is less than the last begins anew: the process was restarted.
    pub fn push(&mut self, now: Duration, value: f64) {
        if self.values.back().is_some_and(|(_, last)| value < *last) {
            self.values.clear();
        }
        self.values.push_back((now, value));
        while self.values.len() > KEPT
            || self.values.front().is_some_and(|(at, _)| now.saturating_sub(*at) > Self::WINDOW)
        {
            self.values.pop_front();
        }
    }

    /// Increase per second; `None` before it is known.
    pub fn per_second(&self) -> Option<f64> {
        let ((from, low), (to, high)) = (self.values.front()?, self.values.back()?);
        let time = to.saturating_sub(*from).as_secs_f64();
        (time > 0.2).then(|| (high - low) / time)
    }

    /// Seconds until it reaches `end` at this rate; `None` where it does not, or before a tenth of the window has passed.
    pub fn time_until(&self, end: f64) -> Option<f64> {
        let ((from, _), (to, last)) = (self.values.front()?, self.values.back()?);
        let rate = self.per_second().filter(|r| *r > 0.0)?;
        (10 * to.saturating_sub(*from) > Self::WINDOW).then(|| (end - last).max(0.0) / rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn the_rate_is_that_of_the_window_and_a_restart_begins_anew() {
        let mut pace = Pace::<10>::default();
        assert_eq!(pace.per_second(), None);
        (0..30).for_each(|n| pace.push(n * SECOND, if n < 20 { 0.0 } else { 5.0 * f64::from(n - 20) }));
        assert_eq!(pace.per_second(), Some(4.5), "from 19 to 29 s");
        assert_eq!(pace.time_until(54.0), Some(2.0));
        pace.push(30 * SECOND, 1.0);
        assert_eq!((pace.per_second(), pace.time_until(54.0)), (None, None));
    }

    #[test]
    fn a_run_that_stands_has_no_end_in_sight() {
        let mut pace = Pace::<10>::default();
        (0..9).for_each(|n| pace.push(n * SECOND, 0.5));
        assert_eq!((pace.per_second(), pace.time_until(1.0)), (Some(0.0), None));
    }

    #[test]
    fn a_flood_of_values_is_bounded() {
        let mut pace = Pace::<1>::default();
        (0..100_000).for_each(|n| pace.push(SECOND, f64::from(n)));
        assert_eq!(pace.values.len(), KEPT);
    }
}
