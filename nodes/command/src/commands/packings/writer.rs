//! Results of packings to stdout and, if set, into a recording.

use super::Found;
use crate::offline_recording::OfflineRecording;
use grainlab_console::{Failure, print, worse};
use grainlab_node_kit::Exit;
use grainlab_results::{Printed, Printer};
use indicatif::ProgressBar;

/// Prints and records results, under a bar that counts them.
pub(crate) struct ResultWriter<R> {
    printer: Printer<R>,
    recording: Option<OfflineRecording>,
    pub(super) bar: ProgressBar,
    pub(super) measured: usize,
    /// Packings that lack what was sought.
    without: usize,
    exit: Exit,
}

impl<R: Printed> ResultWriter<R> {
    pub(crate) fn new(printer: Printer<R>, recording: Option<OfflineRecording>) -> Self {
        let bar = ProgressBar::hidden();
        Self { printer, recording, bar, measured: 0, without: 0, exit: Exit::Done }
    }

    pub(super) fn put(&mut self, found: Result<Found<R>, String>) -> Result<(), Failure> {
        self.measured += 1;
        self.bar.inc(1);
        let found = match found {
            Ok(found) => found,
            Err(message) => {
                self.complain(&[message], Exit::PhysicsInvalid);
                return Ok(());
            }
        };
        self.without += usize::from(found.is_without);
        self.exit = worse(self.exit, if found.is_fault { Exit::PhysicsInvalid } else { Exit::Done });
        let text = self.printer.next(&found.shown)?;
        self.bar.suspend(|| print(&text))?;
        match (&mut self.recording, found.messages) {
            (Some(recording), Ok(messages)) => messages.iter().try_for_each(|m| recording.put(m))?,
            (Some(_), Err(message)) => self.complain(&[message], Exit::PhysicsInvalid),
            (None, _) => {}
        }
        Ok(())
    }

    pub(super) fn complain(&mut self, lines: &[String], exit: Exit) {
        self.bar.suspend(|| lines.iter().for_each(|line| grainlab_console::say!("grainlab: {line}")));
        self.exit = worse(self.exit, exit);
    }

    pub(super) fn finish(self) -> Result<Exit, Failure> {
        self.bar.finish_and_clear();
        print(&self.printer.end()?)?;
        self.recording.map_or(Ok(()), OfflineRecording::finish)?;
        let printed = self.printer.printed();
        let nothing = printed > 0 && self.without == printed;
        Ok(worse(self.exit, if nothing { Exit::PhysicsInvalid } else { Exit::Done }))
    }
}
