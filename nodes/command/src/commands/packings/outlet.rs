//! Results to stdout and, if set, into a recording.

use super::Found;
use super::bar::Bar;
use crate::tape::Tape;
use grainlab_console::{Failure, print};
use grainlab_node_kit::Exit;
use grainlab_results::Printer;

/// Prints and records results.
pub(crate) struct Outlet<F: Found> {
    printer: Printer<F::Shown>,
    tape: Option<Tape>,
    /// Packings that lack what was sought.
    without: usize,
}

impl<F: Found> Outlet<F> {
    pub(crate) fn new(printer: Printer<F::Shown>, tape: Option<Tape>) -> Self {
        Self { printer, tape, without: 0 }
    }

    /// Takes the next result. `bar` is hidden while lines are printed.
    pub(super) fn emit(&mut self, found: &F, bar: &Bar) -> Result<Exit, Failure> {
        self.without += usize::from(found.is_without());
        let text = self.printer.next(found.shown())?;
        bar.around(|| print(&text))?;
        self.tape.as_mut().map_or(Ok(Exit::Done), |tape| found.record(tape, bar))
    }

    /// Completes the output after the last result.
    pub(super) fn finish(self) -> Result<Exit, Failure> {
        print(&self.printer.end()?)?;
        if let Some(tape) = self.tape {
            tape.finish()?;
        }
        let printed = self.printer.printed();
        let none = printed > 0 && self.without == printed;
        Ok(if none { Exit::PhysicsInvalid } else { Exit::Done })
    }
}
