//! Results to stdout and, if set, into a recording.

use super::measure::Found;
use crate::commands::packings;
use crate::commands::packings::bar::Bar;
use crate::tape::Tape;
use grainlab_console::{Failure, print};
use grainlab_msgs::topics;
use grainlab_node_kit::Exit;
use grainlab_results::{Printer, Probed};

/// Prints and records results.
pub(super) struct Outlet {
    printer: Printer<Probed>,
    tape: Option<Tape>,
    /// Packings without wave speeds.
    without: usize,
}

impl Outlet {
    pub(super) fn new(printer: Printer<Probed>, tape: Option<Tape>) -> Self {
        Self { printer, tape, without: 0 }
    }
}

impl packings::Outlet for Outlet {
    type Found = Found;

    fn emit(&mut self, found: Found, bar: &Bar) -> Result<Exit, Failure> {
        self.without += usize::from(found.messages.is_none());
        let text = self.printer.next(&found.probed)?;
        bar.around(|| print(&text))?;
        let (Some(tape), Some(messages)) = (&mut self.tape, &found.messages) else { return Ok(Exit::Done) };
        for waveform in &messages.waveforms {
            tape.put(&topics::WAVEFORM, &waveform.header, waveform)?;
        }
        let speeds = &messages.wave_speeds;
        tape.put(&topics::WAVE_SPEEDS, &speeds.header, speeds)?;
        Ok(Exit::Done)
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
