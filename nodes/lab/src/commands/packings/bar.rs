//! Progress on a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Period of the updates while a large packing is measured.
const TICK: Duration = Duration::from_millis(250);

/// A progress bar on stderr; hidden if that is not a terminal.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    /// Without a bar.
    pub(crate) fn hidden() -> Self {
        Self(ProgressBar::hidden())
    }

    /// For this number of files.
    pub(crate) fn of(files: usize) -> Self {
        let bar = ProgressBar::new(files as u64);
        let template = "{bar:30} {pos} of {len} files, {msg}, {elapsed}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_message("0 packings");
        bar.enable_steady_tick(TICK);
        Self(bar)
    }

    pub(crate) fn packings(&self, count: usize) {
        self.0.set_message(grainlab_console::count(count, "packing"));
    }

    pub(crate) fn file_done(&self) {
        self.0.inc(1);
    }

    /// Runs `print` while the bar is hidden.
    pub(crate) fn around<T>(&self, print: impl FnOnce() -> T) -> T {
        self.0.suspend(print)
    }

    /// Prints a line on stderr.
    pub(crate) fn say(&self, line: &str) {
        self.around(|| grainlab_console::say!("{line}"));
    }

    pub(crate) fn clear(&self) {
        self.0.finish_and_clear();
    }
}
