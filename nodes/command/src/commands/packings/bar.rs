//! Progress on a terminal.

use grainlab_console::count;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Period of the updates while a large packing is measured.
const TICK: Duration = Duration::from_millis(250);

/// A progress bar on stderr; hidden if that is not a terminal. It counts packings measured, of those found so far and those
/// expected in the files that have not been read.
pub(crate) struct Bar {
    bar: ProgressBar,
    files: usize,
    seen: Seen,
}

/// What has been read and measured.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    files: usize,
    found: usize,
    measured: usize,
}

impl Seen {
    /// The number of packings, with as many in each file that has not been read as in the others, and at least one.
    fn expected(&self, files: usize) -> usize {
        let each = self.found.div_ceil(self.files.max(1)).max(1);
        // A file that is being read has more packings to come, but one at least has been found in it.
        (self.found + files.saturating_sub(self.files) * each
            - usize::from(self.files < files && self.found > 0))
        .max(self.found)
    }
}

impl Bar {
    /// Without a bar.
    pub(crate) fn hidden() -> Self {
        Self { bar: ProgressBar::hidden(), files: 0, seen: Seen::default() }
    }

    /// For this number of files.
    pub(crate) fn of(files: usize) -> Self {
        let bar = ProgressBar::new(files as u64);
        bar.enable_steady_tick(TICK);
        let this = Self { bar, files, seen: Seen::default() };
        this.show();
        this
    }

    /// A packing was read.
    pub(crate) fn found(&mut self) {
        self.seen.found += 1;
        self.show();
    }

    /// This many packings are measured.
    pub(crate) fn measured(&mut self, count: usize) {
        self.seen.measured = count;
        self.show();
    }

    /// A file has been read to its end.
    pub(crate) fn file_read(&mut self) {
        self.seen.files += 1;
        self.show();
    }

    fn show(&self) {
        let Seen { files, measured, .. } = self.seen;
        // The time left is not known before the first packing.
        let left = if measured == 0 { "{elapsed}" } else { "{eta} left" };
        let template = format!("{{bar:30}} {{pos}} of {{len}} packings, {{msg}}, {left}");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            self.bar.set_style(style);
        }
        self.bar.set_length(self.seen.expected(self.files) as u64);
        self.bar.set_position(measured as u64);
        self.bar.set_message(format!("{files} of {} read", count(self.files, "file")));
    }

    /// Runs `print` while the bar is hidden.
    pub(crate) fn around<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    /// Prints a line on stderr.
    pub(crate) fn say(&self, line: &str) {
        self.around(|| grainlab_console::say!("{line}"));
    }

    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::Seen;

    #[test]
    fn a_bar_is_full_when_all_packings_are_measured_and_not_before() {
        let expected = |files, found, of| Seen { files, found, measured: 0 }.expected(of);
        // Nothing read yet, one packing of the file that is being read, and the whole file.
        assert_eq!([expected(0, 0, 1), expected(0, 1, 1), expected(1, 4, 1)], [1, 1, 4]);
        // Three files not read, each expected to have as many packings as the first.
        assert_eq!(expected(1, 4, 4), 15);
        assert_eq!(expected(4, 9, 4), 9);
    }
}
