//! Results in order: each one is passed on as soon as all before it have been.

use super::Found;
use super::bar::Bar;
use super::outlet::Outlet;
use grainlab_console::{Failure, worse};
use grainlab_node_kit::Exit;
use std::collections::BTreeMap;

/// File and index of a packing.
pub(crate) type Place = (usize, usize);

/// Warnings of a source that has been read to its end.
#[derive(Debug)]
pub(crate) struct Ending {
    /// Number of its packings.
    pub(crate) packings: usize,
    pub(crate) complaints: Vec<String>,
    pub(crate) exit: Exit,
}

/// Passes results on. Early ones are stored; a result is small.
pub(crate) struct Sink<F: Found> {
    outlet: Outlet<F>,
    /// The first one that has not been passed on.
    next: Place,
    waiting: BTreeMap<Place, Result<F, String>>,
    endings: BTreeMap<usize, Ending>,
    exit: Exit,
    measured: usize,
    /// The bar to hide while lines are printed.
    pub(super) bar: Bar,
}

impl<F: Found> Sink<F> {
    /// Without results.
    pub(crate) fn new(outlet: Outlet<F>) -> Self {
        Self {
            outlet,
            next: (0, 0),
            waiting: BTreeMap::new(),
            endings: BTreeMap::new(),
            exit: Exit::Done,
            measured: 0,
            bar: Bar::hidden(),
        }
    }

    /// Takes the result of one packing.
    pub(crate) fn put(&mut self, place: Place, found: Result<F, String>) -> Result<(), Failure> {
        self.waiting.insert(place, found);
        self.measured += 1;
        self.advance()
    }

    /// Takes the end of a source, whose number of packings is then known.
    pub(crate) fn end(&mut self, file: usize, ending: Ending) -> Result<(), Failure> {
        self.endings.insert(file, ending);
        self.bar.file_read();
        self.advance()
    }

    /// Takes note of a packing that was read.
    pub(crate) fn found(&mut self) {
        self.bar.found();
    }

    /// Packings measured so far.
    pub(crate) fn measured(&self) -> usize {
        self.measured
    }

    fn advance(&mut self) -> Result<(), Failure> {
        self.bar.measured(self.measured);
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

    fn emit(&mut self, found: Result<F, String>) -> Result<(), Failure> {
        let exit = match found {
            Ok(found) => self.outlet.emit(&found, &self.bar)?,
            Err(message) => {
                self.bar.say(&format!("grainlab: {message}"));
                Exit::PhysicsInvalid
            }
        };
        self.exit = worse(self.exit, exit);
        Ok(())
    }

    /// Passes on the results after a gap, and completes the output.
    pub(crate) fn finish(mut self) -> Result<Exit, Failure> {
        for (_, found) in std::mem::take(&mut self.waiting) {
            self.emit(found)?;
        }
        for (_, ending) in std::mem::take(&mut self.endings) {
            self.complain(ending);
        }
        self.bar.clear();
        Ok(worse(self.exit, self.outlet.finish()?))
    }
}
