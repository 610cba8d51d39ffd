//! Results in the order asked for: each is printed as soon as all before it are.

use super::bar::Bar;
use super::measure::Found;
use super::record::Recorder;
use crate::failure::{Failure, worse};
use crate::output::{Format, print};
use crate::results::state::{self, State};
use crate::results::state_text;
use node_kit::Exit;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Which packing of which file.
pub(super) type Place = (usize, usize);

/// What there was to say of a source that has been read to its end.
#[derive(Debug)]
pub(super) struct Ending {
    /// Packings it gave.
    pub(super) packings: usize,
    pub(super) complaints: Vec<String>,
    pub(super) exit: Exit,
}

/// Prints and records results. What comes too early waits; a result is small.
pub(super) struct Sink {
    printer: Printer,
    recorder: Option<Recorder>,
    /// The first that has not been printed.
    next: Place,
    waiting: BTreeMap<Place, Result<Found, String>>,
    endings: BTreeMap<usize, Ending>,
    exit: Exit,
    /// Packings without a stiffness, and all.
    without: usize,
    measured: usize,
    /// Where lines on stderr must make way for a bar.
    pub(super) bar: Bar,
}

impl Sink {
    /// `columns` of CSV; none for all.
    pub(super) fn new(
        format: Format,
        columns: Vec<String>,
        recorder: Option<Recorder>,
    ) -> Result<Self, Failure> {
        let printer = Printer { format, columns, printed: 0 };
        if !printer.columns.is_empty() && format != Format::Csv {
            return Err(Failure::usage("--columns is for --format csv"));
        }
        // An unknown column is better refused before the work than after it.
        printer.csv(&[])?;
        Ok(Self {
            printer,
            recorder,
            next: (0, 0),
            waiting: BTreeMap::new(),
            endings: BTreeMap::new(),
            exit: Exit::Done,
            without: 0,
            measured: 0,
            bar: Bar::hidden(),
        })
    }

    /// Takes what was found of one packing.
    pub(super) fn put(&mut self, place: Place, found: Result<Found, String>) -> Result<(), Failure> {
        self.waiting.insert(place, found);
        self.measured += 1;
        self.advance()
    }

    /// Takes the end of a source: its packings are known now.
    pub(super) fn end(&mut self, file: usize, ending: Ending) -> Result<(), Failure> {
        self.endings.insert(file, ending);
        self.bar.file_done();
        self.advance()
    }

    /// Packings measured so far.
    pub(super) fn measured(&self) -> usize {
        self.measured
    }

    fn advance(&mut self) -> Result<(), Failure> {
        self.bar.packings(self.measured);
        loop {
            if let Some(found) = self.waiting.remove(&self.next) {
                self.next.1 += 1;
                self.emit(found)?;
            } else if self.endings.get(&self.next.0).is_some_and(|e| e.packings == self.next.1) {
                if let Some(ending) = self.endings.remove(&self.next.0) {
                    self.complain(ending);
                }
                self.next = (self.next.0 + 1, 0);
            } else {
                return Ok(());
            }
        }
    }

    fn complain(&mut self, ending: Ending) {
        for line in ending.complaints {
            self.bar.say(&format!("grainlab: {line}"));
        }
        self.exit = worse(self.exit, ending.exit);
    }

    fn emit(&mut self, found: Result<Found, String>) -> Result<(), Failure> {
        let found = match found {
            Ok(found) => found,
            Err(message) => {
                self.bar.say(&format!("grainlab: {message}"));
                self.exit = worse(self.exit, Exit::PhysicsInvalid);
                return Ok(());
            }
        };
        self.without += usize::from(found.state.stiffness_pa.is_none());
        let text = self.printer.next(&found.state)?;
        self.bar.around(|| print(&text))?;
        let Some(recorder) = &mut self.recorder else { return Ok(()) };
        match &found.messages {
            Ok(measured) => recorder.write(measured),
            Err(message) => {
                self.bar.say(&format!("grainlab: {message}"));
                self.exit = worse(self.exit, Exit::PhysicsInvalid);
                Ok(())
            }
        }
    }

    /// Prints and records whatever still waits behind a gap, and completes both.
    pub(super) fn finish(mut self) -> Result<Exit, Failure> {
        for (_, found) in std::mem::take(&mut self.waiting) {
            self.emit(found)?;
        }
        for (_, ending) in std::mem::take(&mut self.endings) {
            self.complain(ending);
        }
        self.bar.clear();
        print(&self.printer.end()?)?;
        if let Some(recorder) = self.recorder.take() {
            recorder.finish()?;
        }
        let printed = self.printer.printed;
        if printed > 0 && self.without == printed {
            self.exit = worse(self.exit, Exit::PhysicsInvalid);
        }
        Ok(self.exit)
    }
}

/// Texts that, one after the other, are one table, one JSON array or one CSV.
struct Printer {
    format: Format,
    /// Of CSV; none for all.
    columns: Vec<String>,
    printed: usize,
}

impl Printer {
    fn next(&mut self, state: &State) -> Result<String, Failure> {
        let first = self.printed == 0;
        self.printed += 1;
        Ok(match self.format {
            Format::Table => format!("{}, step {}\n{}", state.source, state.step, state_text::text(state)),
            Format::Csv => {
                let text = self.csv(std::slice::from_ref(state))?;
                match text.split_once('\n') {
                    Some((_, row)) if !first => row.to_owned(),
                    _ => text,
                }
            }
            Format::Json => {
                let element =
                    serde_json::to_string_pretty(state).map_err(|e| Failure::failed(format!("JSON: {e}")))?;
                let mut text = String::from(if first { "[" } else { "," });
                for line in element.lines() {
                    // Writing to a String cannot fail.
                    let _ = write!(text, "\n  {line}");
                }
                text
            }
        })
    }

    fn end(&self) -> Result<String, Failure> {
        Ok(match (self.format, self.printed) {
            (Format::Json, 0) => "[]\n".to_owned(),
            (Format::Json, _) => "\n]\n".to_owned(),
            (Format::Csv, 0) => self.csv(&[])?,
            _ => String::new(),
        })
    }

    fn csv(&self, states: &[State]) -> Result<String, Failure> {
        let table = state::table(states);
        if self.columns.is_empty() {
            return Ok(table.csv());
        }
        let unknown = |name| {
            let known = table.header().join(", ");
            Failure::usage(format!("--columns: there is no column {name:?}; there are: {known}"))
        };
        Ok(table.select(&self.columns).map_err(unknown)?.csv())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grains::{Cell, Mat3, Material, Packing, Vec3};

    fn state(step: u64) -> State {
        let packing = Packing {
            step,
            time: 0.0,
            cell: Cell::cube(1.0).unwrap(),
            deformation: Mat3::identity(),
            ids: vec![0],
            radii: vec![0.1],
            positions: vec![Vec3::zeros()],
            velocities: vec![Vec3::zeros()],
            spins: vec![Vec3::zeros()],
            contacts: Vec::new(),
            material: Material::GLASS,
            friction: 0.1,
            time_step: 0.0,
        };
        let found = micro::analyse(&packing, &micro::Settings::default()).unwrap();
        State::new("a, \"b\"".into(), &packing, &found.fabric, None)
    }

    #[test]
    fn results_printed_one_by_one_are_the_text_of_all() {
        for count in 0..4 {
            let states: Vec<State> = (0..count).map(state).collect();
            let text = |format| {
                let mut printer = Printer { format, columns: Vec::new(), printed: 0 };
                let parts: String = states.iter().map(|s| printer.next(s).unwrap()).collect();
                parts + &printer.end().unwrap()
            };
            assert_eq!(text(Format::Json), crate::output::json(&states).unwrap());
            assert_eq!(text(Format::Csv), state::csv(&states));
        }
    }
}
