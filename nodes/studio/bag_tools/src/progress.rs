//! A line on the terminal while a command takes longer than a second, and its end by a signal.

use grainlab_console::{Failure, Signals, Terminal, draw_live_line, duration, erase_live_line};
use grainlab_msgs::Exit;
use std::cell::Cell;
use std::time::{Duration, Instant};

pub(crate) struct Progress {
    begin: Instant,
    signals: Signals,
    terminal: Option<Terminal>,
    last: Cell<Duration>,
    /// First log time and length of the interval, ns.
    interval: (u64, u64),
}

impl Progress {
    /// From here on SIGINT, SIGTERM and SIGHUP end the command in [`Progress::at`], so that its temporary files are removed.
    pub(crate) fn new(interval: Option<(u64, u64)>) -> Result<Self, Failure> {
        let signals = Signals::install().map_err(Failure::failed)?;
        let interval = interval.map_or((0, 0), |(from, to)| (from, to.saturating_sub(from)));
        let (begin, terminal) = (Instant::now(), Terminal::on_stderr());
        Ok(Self { begin, signals, terminal, last: Cell::default(), interval })
    }

    /// Draws the line, at most five times per second and after the first second; an error after a signal.
    pub(crate) fn at(&self, log_time: u64) -> Result<(), Failure> {
        if self.signals.requested() {
            return Err(Failure::new(Exit::Interrupted, "interrupted: nothing was written"));
        }
        if self.terminal.is_none() {
            return Ok(());
        }
        let now = self.begin.elapsed();
        if now.saturating_sub(self.last.get())
            < Duration::from_millis(if self.is_drawn() { 200 } else { 1000 })
        {
            return Ok(());
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
        Ok(())
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
