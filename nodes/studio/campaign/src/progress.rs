//! The progress of a campaign, with the time left.

use grainlab_console::duration;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

/// Counts of members, as a bar on a terminal and as lines elsewhere.
pub(crate) struct Progress {
    members: usize,
    done: usize,
    before: usize,
    failed: usize,
    running: usize,
    began: Instant,
    /// Hidden where the standard error is no terminal.
    bar: ProgressBar,
}

impl Progress {
    pub(crate) fn new(members: usize, done: usize, failed: usize) -> Self {
        let style = ProgressStyle::with_template("{bar:30} {pos} of {len}{msg}");
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::new(members as u64).with_style(style);
        let before = done + failed;
        let new = Self { members, done, before, failed, running: 0, began: Instant::now(), bar };
        if before > 0 {
            let failed = match failed {
                0 => String::new(),
                n => format!(", {n} failed (--redo-failed runs them again)"),
            };
            new.say(&format!("{done} of {members} members were done before{failed}"));
        }
        new.draw();
        new
    }

    pub(crate) fn finished(&mut self, name: &str, took: Duration) {
        self.done += 1;
        self.line(&format!("{name} in {:.1} s", took.as_secs_f64()));
    }

    pub(crate) fn failed(&mut self, name: &str) {
        self.failed += 1;
        self.line(&format!("{name} failed"));
    }

    /// A member was interrupted, and is continued.
    pub(crate) fn again(&mut self, name: &str) {
        self.say(&format!("{name} was interrupted, and is continued"));
    }

    pub(crate) fn running(&mut self, running: usize) {
        self.running = running;
        self.draw();
    }

    pub(crate) fn end(&self) {
        self.bar.finish_and_clear();
    }

    fn line(&self, what: &str) {
        self.draw();
        if self.bar.is_hidden() {
            let (ended, members, left) = (self.done + self.failed, self.members, self.left());
            grainlab_console::say!("grainlab: {ended} of {members}{left}: {what}");
        }
    }

    fn say(&self, what: &str) {
        self.bar.suspend(|| grainlab_console::say!("grainlab: {what}"));
    }

    fn draw(&self) {
        self.bar.set_position((self.done + self.failed) as u64);
        let failed = if self.failed > 0 { format!(", {} failed", self.failed) } else { String::new() };
        self.bar.set_message(format!("{failed}, {} running{}", self.running, self.left()));
    }

    fn left(&self) -> String {
        let ended = self.done + self.failed - self.before;
        let open = self.members - self.done - self.failed;
        if ended == 0 || open == 0 {
            return String::new();
        }
        let left = self.began.elapsed().as_secs_f64() / ended as f64 * open as f64;
        format!(", {} left", duration(left))
    }
}
