//! `Note`: what a result cannot tell, or why.

use super::check::Check;
use super::error::BoundaryError;
use crate::msg;
use grainlab_core::notes::{Note, Status};

pub(super) fn status_code(status: Status) -> u8 {
    match status {
        Status::Ok => msg::Estimate::STATUS_OK,
        Status::Extrapolated => msg::Estimate::STATUS_EXTRAPOLATED,
        Status::Contradictory => msg::Estimate::STATUS_CONTRADICTORY,
        Status::Unknown => msg::Estimate::STATUS_UNKNOWN,
    }
}

pub(super) fn status(check: Check, field: &str, code: u8) -> Result<Status, BoundaryError> {
    let allowed = "0 (ok), 1 (extrapolated), 2 (contradictory), 3 (unknown)";
    let known = Status::ALL.into_iter().find(|status| status_code(*status) == code);
    known.ok_or_else(|| check.code(field, code, allowed))
}

pub(super) fn note_message(note: &Note) -> msg::Note {
    msg::Note {
        code: note.code().to_owned(),
        severity: status_code(note.severity()),
        subjects: note.subjects().iter().map(|name| name.clone().into_owned()).collect(),
        numbers: note.values().to_vec(),
        text: note.to_string(),
    }
}

/// Returns the notes of a result with this status. Earlier versions and other programs send sentences alone; the first sentence
/// is the reason for the status.
pub(super) fn notes(
    check: Check,
    notes: &[msg::Note],
    sentences: &[String],
    status: Status,
) -> Result<Vec<Note>, BoundaryError> {
    if !notes.is_empty() {
        return notes.iter().enumerate().map(|(n, m)| note(check, &format!("notes[{n}]"), m)).collect();
    }
    let severity = |n| if n == 0 { status } else { Status::Ok };
    let sentence = |(n, text): (usize, &String)| Note::from_parts("", severity(n), &[], &[], text);
    Ok(sentences.iter().enumerate().map(sentence).collect())
}

fn note(check: Check, field: &str, m: &msg::Note) -> Result<Note, BoundaryError> {
    let severity = status(check, &format!("{field}.severity"), m.severity)?;
    Ok(Note::from_parts(&m.code, severity, &m.subjects, &m.numbers, &m.text))
}
