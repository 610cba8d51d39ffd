//! Modes that are left out of a measurement.

use crate::error::AcousticsError;
use grainlab_core::notes::Note;

/// Takes what was measured, and returns the first error of what was left out. A failure for want of a signal or a solution is left
/// out with a note.
///
/// # Errors
/// If everything failed, the first error; any other failure.
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
