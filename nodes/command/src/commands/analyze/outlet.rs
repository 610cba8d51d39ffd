//! Results to stdout and, if set, into a recording.

use super::measure::Found;
use crate::commands::packings;
use crate::commands::packings::bar::Bar;
use crate::tape::Tape;
use grainlab_console::{Failure, print};
use grainlab_msgs::topics;
use grainlab_node_kit::Exit;
use grainlab_results::{MeasuredPacking, Printer, yields};

/// Prints and records results.
pub(super) struct Outlet {
    printer: Printer<MeasuredPacking>,
    tape: Option<Tape>,
    /// Packings without a stiffness, or with one that some strain does not load: no wave passes them.
    without: usize,
}

impl Outlet {
    pub(super) fn new(printer: Printer<MeasuredPacking>, tape: Option<Tape>) -> Self {
        Self { printer, tape, without: 0 }
    }
}

impl packings::Outlet for Outlet {
    type Found = Found;

    fn emit(&mut self, found: Found, bar: &Bar) -> Result<Exit, Failure> {
        self.without +=
            usize::from(found.packing.report.stiffness().is_none() || yields(&found.packing.report));
        let text = self.printer.next(&found.packing)?;
        bar.around(|| print(&text))?;
        let Some(tape) = &mut self.tape else { return Ok(Exit::Done) };
        match &found.message {
            Ok(report) => {
                tape.put(&topics::PACKING_REPORT, &report.header, report)?;
                Ok(Exit::Done)
            }
            Err(message) => {
                bar.say(&format!("grainlab: {message}"));
                Ok(Exit::PhysicsInvalid)
            }
        }
    }

    fn finish(self) -> Result<Exit, Failure> {
        print(&self.printer.end()?)?;
        if let Some(tape) = self.tape {
            tape.finish()?;
        }
        let printed = self.printer.printed();
        let none = printed > 0 && self.without == printed;
        Ok(if none { Exit::PhysicsInvalid } else { Exit::Done })
    }
}
