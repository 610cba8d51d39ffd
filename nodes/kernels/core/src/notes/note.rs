//! A note on a result.

use super::code::Code;
use super::shown::Shown;
use super::status::Status;
use super::table::with_table;
use std::borrow::Cow;
use std::fmt;

/// A limitation of a result, or the reason for its status: a code, names and numbers for programs, a sentence for readers.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    kind: Kind,
    severity: Status,
    subjects: Vec<Cow<'static, str>>,
    values: Vec<f64>,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    Listed(Code),
    /// A note of another program or version, with the sentence that came with it.
    Foreign {
        code: String,
        text: String,
    },
}

impl Note {
    fn listed(code: Code, subjects: Vec<Cow<'static, str>>, values: Vec<f64>) -> Self {
        Self { kind: Kind::Listed(code), severity: code.severity(), subjects, values }
    }

    /// Creates a note from its parts, as a message has them. A code of this program makes the sentence anew; a note with another
    /// code keeps `text`.
    pub fn from_parts(code: &str, severity: Status, subjects: &[String], values: &[f64], text: &str) -> Self {
        let listed = Code::named(code).filter(|code| code.fits(subjects.len(), values.len()));
        let foreign = || Kind::Foreign { code: code.to_owned(), text: text.to_owned() };
        Self {
            kind: listed.map_or_else(foreign, Kind::Listed),
            severity,
            subjects: subjects.iter().cloned().map(Cow::Owned).collect(),
            values: values.to_vec(),
        }
    }

    /// Returns the note with a worse status, if `severity` is worse.
    #[must_use]
    pub fn raised(self, severity: Status) -> Self {
        Self { severity: self.severity.max(severity), ..self }
    }

    /// Returns the code for programs.
    pub fn code(&self) -> &str {
        match &self.kind {
            Kind::Listed(code) => code.name(),
            Kind::Foreign { code, .. } => code,
        }
    }

    /// Returns true if the note has this code.
    pub fn is(&self, code: Code) -> bool {
        self.kind == Kind::Listed(code)
    }

    /// Returns the status that the note gives an estimate.
    pub const fn severity(&self) -> Status {
        self.severity
    }

    /// Returns the names in the sentence: of a quantity, a modulus, a model.
    pub fn subjects(&self) -> &[Cow<'static, str>] {
        &self.subjects
    }

    /// Returns true if this name is one of those in the sentence.
    pub fn names(&self, subject: &str) -> bool {
        self.subjects.iter().any(|name| name == subject)
    }

    /// Returns the numbers in the sentence, SI units.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the numbers with their names; none for a note of another program.
    pub fn named_values(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let names = if let Kind::Listed(code) = self.kind { code.numbers() } else { &[] };
        names.iter().copied().zip(self.values.iter().copied())
    }

    /// Returns the number with this name; `None` if the note has none.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.named_values().find(|(known, _)| *known == name).map(|(_, value)| value)
    }

    /// Returns true if the notes differ by their numbers alone, so that one sentence with ranges says both.
    pub fn is_like(&self, other: &Self) -> bool {
        (&self.kind, self.severity, &self.subjects) == (&other.kind, other.severity, &other.subjects)
    }

    /// Returns the sentence of several notes that are alike, with the range of each number.
    pub fn text_of<'a>(notes: impl IntoIterator<Item = &'a Self>) -> String {
        let mut notes = notes.into_iter();
        let Some(first) = notes.next() else { return String::new() };
        let Kind::Listed(code) = first.kind else { return first.to_string() };
        let mut ranges: Vec<Shown> = first.values.iter().copied().map(Shown::from).collect();
        for note in notes {
            ranges.iter_mut().zip(&note.values).for_each(|(range, value)| range.widen(*value));
        }
        code.text(&first.subjects, &ranges)
    }
}

/// Returns the sentence of each note.
pub fn texts<'a>(notes: impl IntoIterator<Item = &'a Note>) -> Vec<String> {
    notes.into_iter().map(ToString::to_string).collect()
}

/// The sentence, without a full stop.
macro_rules! constructors {
    ($($(#[$doc:meta])* $variant:ident $code:ident $status:ident [$($subject:ident)*] ($($number:ident)*) $text:expr;)+) => {
        impl Note {
            $(
                $(#[$doc])*
                #[allow(clippy::too_many_arguments, reason = "one for each number of the sentence")]
                pub fn $code($($subject: impl Into<Cow<'static, str>>,)* $($number: f64,)*) -> Self {
                    Self::listed(Code::$variant, vec![$($subject.into(),)*], vec![$($number,)*])
                }
            )+
        }
    };
}

with_table!(constructors);

impl Status {
    /// Returns the status of an estimate with these notes: the worst of theirs.
    pub fn of(notes: &[Note]) -> Self {
        notes.iter().map(|note| note.severity).max().unwrap_or_default()
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            Kind::Listed(_) => f.write_str(&Self::text_of([self])),
            Kind::Foreign { text, .. } => f.write_str(text),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_is_unique_and_has_a_sentence_that_a_message_brings_back() {
        for code in Code::ALL {
            assert_eq!(Code::named(code.name()), Some(*code));
            let subjects = vec!["one".to_owned(); code.subjects().len()];
            let values = vec![0.25; code.numbers().len()];
            let note = Note::from_parts(code.name(), code.severity(), &subjects, &values, "");
            assert!(
                note.is(*code) && !note.to_string().is_empty() && !note.to_string().ends_with('.'),
                "{note}"
            );
        }
    }

    #[test]
    fn a_note_of_another_version_keeps_its_sentence_and_its_status() {
        let note = Note::from_parts("new_here", Status::Extrapolated, &[], &[1.0], "the moon is full");
        assert_eq!((note.code(), note.to_string().as_str()), ("new_here", "the moon is full"));
        let longer = Note::from_parts("ratio_unusual", Status::Extrapolated, &[], &[1.0, 2.0], "as sent");
        assert!(!longer.is(Code::RatioUnusual) && longer.to_string() == "as sent");
        assert_eq!(Status::of(&[note, Note::grains_unknown()]), Status::Extrapolated);
        assert_eq!(Status::of(&[]), Status::Ok);
    }

    #[test]
    fn notes_that_differ_by_numbers_have_one_sentence_with_their_range() {
        let notes = [0.61, 0.55, 0.64].map(Note::ratio_unusual);
        assert!(notes.iter().all(|note| note.is_like(&notes[0])));
        assert_eq!(
            Note::text_of(&notes),
            "G13/G12 = 0.5500 to 0.6400 is outside [2/3, 3/2], the range of contact anisotropy alone"
        );
        assert!(!Note::prior_unused("z").is_like(&Note::prior_unused("eps")));
    }

    #[test]
    fn a_number_and_the_end_that_it_is_beyond_never_look_equal() {
        let text = Note::too_far("p/E*", "grainlab", 1.1e-12, 2.3e-8, 1.63e-4).to_string();
        assert!(text.contains("p/E* = 1.10e-12 is") && text.contains("[2.30e-8, 1.63e-4]"), "{text}");
        let near = Note::state_outside_calibration("p/E*", 1.6301e-4, 2e-8, 1.63e-4).to_string();
        assert!(near.contains("1.6301e-4 is outside"), "{near}");
        let inside = |value| Note::state_outside_calibration("q/p", value, 0.61834, 0.64663).to_string();
        assert!(inside(0.65).starts_with("q/p = 0.6500 is outside 0.6183 to 0.6466,"));
        assert!(inside(0.646634).starts_with("q/p = 0.646634 is outside 0.618340 to 0.646630,"));
        assert!(inside(0.618339).starts_with("q/p = 0.618339 is outside 0.618340 to 0.646630,"));
        let above = Note::above_calibration("z", 4.000_01, 4.0).to_string();
        assert!(above.starts_with("z = 4.00001 is above 4.00000,"), "{above}");
        let ratio = Note::too_far("q/p", "x", 0.5, 0.0, 0.49999).to_string();
        assert_eq!(ratio.matches("0.50000").count(), 1, "{ratio}");
    }
}
