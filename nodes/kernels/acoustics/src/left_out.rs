//! Modes that are left out of a measurement.

use crate::error::AcousticsError;
use grainlab_core::notes::Note;

/// Leaves out failures for want of a signal or a solution, with notes, and returns the first.
/// Fails on any other failure, and where everything failed.
pub(crate) fn keep<T>(
    results: Vec<Result<T, AcousticsError>>,
    notes: &mut Vec<Note>,
    mut take: impl FnMut(T, &mut Vec<Note>),
) -> Result<Option<AcousticsError>, AcousticsError> {
    let (mut taken, mut first_error) = (false, None);
    for result in results {
        match result {
            Ok(found) => {
                taken = true;
                take(found, notes);
            }
            Err(error @ (AcousticsError::NotConverged { .. } | AcousticsError::NoSignal { .. })) => {
                notes.push(Note::left_out(error.to_string()));
                first_error = first_error.or(Some(error));
            }
            Err(error) => return Err(error),
        }
    }
    if taken { Ok(first_error) } else { first_error.map_or(Ok(None), Err) }
}
