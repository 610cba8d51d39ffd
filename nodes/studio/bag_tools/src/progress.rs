//! A line on the terminal while a command takes longer than a second.

use grainlab_console::{Terminal, draw_live_line, duration, erase_live_line};
use std::cell::Cell;
use std::time::{Duration, Instant};

/// The part of an interval of log time that is done.
pub(crate) struct Progress {
    begin: Instant,
    terminal: Option<Terminal>,
    last: Cell<Duration>,
    /// First log time and length of the interval, ns.
    interval: (u64, u64),
}

impl Progress {
    pub(crate) fn new(interval: Option<(u64, u64)>) -> Self {
        let interval = interval.map_or((0, 0), |(from, to)| (from, to.saturating_sub(from)));
        Self { begin: Instant::now(), terminal: Terminal::on_stderr(), last: Cell::default(), interval }
    }

    /// Draws the line, at most five times per second and after the first second.
    pub(crate) fn at(&self, log_time: u64) {
        if self.terminal.is_none() {
            return;
        }
        let now = self.begin.elapsed();
        if now.saturating_sub(self.last.get())
            < Duration::from_millis(if self.is_drawn() { 200 } else { 1000 })
        {
            return;
        }
        self.last.set(now);
        let (from, length) = self.interval;
        let part = log_time.saturating_sub(from) as f64 / length.max(1) as f64;
        let left = now.mul_f64((1.0 / part.clamp(1e-6, 1.0) - 1.0).min(1e6));
        draw_live_line(&format!(
            "{:3.0} % of the recording, {} left",
            1e2 * part.min(1.0),
            duration(left.as_secs_f64())
        ));
    }

    fn is_drawn(&self) -> bool {
        !self.last.get().is_zero()
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if self.is_drawn() {
            erase_live_line();
        }
    }
}
