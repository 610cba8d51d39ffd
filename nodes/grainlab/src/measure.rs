//! A packing measured.

use crate::{Error, State};
use grainlab_core::notes::Note;
use grainlab_core::results::{PackingReport, warnings};
use grainlab_micromechanics::{Settings, analyze};
use std::ops::Deref;

/// Structure, stress and stiffness of a packing, and reasons to doubt them.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Measured quantities, about e3.
    pub report: PackingReport,
    /// Notes on the import of the packing, and warnings as `grainlab analyze` prints them: motion, forces that do not balance or
    /// are not those of the contact law, contacts that are missing. None for most packings at rest.
    pub notes: Vec<Note>,
}

impl Deref for Measurement {
    type Target = PackingReport;

    fn deref(&self) -> &PackingReport {
        &self.report
    }
}

/// Measures a packing as `grainlab analyze` does.
///
/// # Errors
/// If there are no grains, if the packing contradicts itself, or if the stiffness cannot be solved for. A packing that is not
/// jammed is no error: its report has no stiffness, and the reason.
pub fn measure(state: &State) -> Result<Measurement, Error> {
    let failed = |e: &dyn std::fmt::Display| Error::Measurement(e.to_string());
    if state.grains() == 0 {
        return Err(failed(&"the packing has no grains"));
    }
    state.packing.check().and_then(|()| state.packing.check_consistency()).map_err(|e| failed(&e))?;
    let report = analyze(&state.packing, &Settings::default()).map_err(|e| failed(&e))?.report;
    let found = warnings(&state.packing, &report).into_iter();
    let found = found.filter(|note| !state.notes.contains(&note.to_string()));
    let notes = state.notes.iter().cloned().map(Note::remark).chain(found).collect();
    Ok(Measurement { report, notes })
}
