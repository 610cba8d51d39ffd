//! A packing with its place in a run.

use grainlab_core::Packing;
use grainlab_recordings::import::Imported;
use std::ops::Deref;

/// A packing, and where on the loading path of its run it is. Make one of a packing of your own by `State::from`.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// State of the grains.
    pub packing: Packing,
    /// Run state, as recorded with the packing: the two resume the run. Empty: the packing is of no run.
    pub run_state: Vec<u8>,
    /// Notes on its import: contacts found from positions, quantities that disagree.
    pub notes: Vec<String>,
}

impl Deref for State {
    type Target = Packing;

    fn deref(&self) -> &Packing {
        &self.packing
    }
}

impl From<Packing> for State {
    fn from(packing: Packing) -> Self {
        Self { packing, run_state: Vec::new(), notes: Vec::new() }
    }
}

impl From<Imported> for State {
    fn from(imported: Imported) -> Self {
        Self { packing: imported.packing, run_state: imported.run_state, notes: imported.notes }
    }
}
