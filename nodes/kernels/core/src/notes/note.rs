//! A note on a result, and the status that notes give it.

use super::Code;
use super::shown::Shown;
use std::borrow::Cow;
use std::fmt;

/// Reliability of an estimate, from the best to the worst. A note has the status that it gives an estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// Model and calibration were used inside their range, and the data agree with each other and with the model.
    #[default]
    Ok,
    /// Model or calibration were used outside their range.
    Extrapolated,
    /// The data contradict each other, the model or the prior.
    Contradictory,
    /// There is no estimate, or one that determines nothing.
    Unknown,
}

impl Status {
    /// Every status, in the order of the codes of messages.
    pub const ALL: [Self; 4] = [Self::Ok, Self::Extrapolated, Self::Contradictory, Self::Unknown];

    /// Returns the name in texts, files and results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Extrapolated => "extrapolated",
            Self::Contradictory => "contradictory",
            Self::Unknown => "unknown",
        }
    }

    /// Returns the status of an estimate with these notes: the worst of theirs.
    pub fn of(notes: &[Note]) -> Self {
        notes.iter().map(|note| note.severity).max().unwrap_or_default()
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

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
    pub(super) fn listed(code: Code, subjects: Vec<Cow<'static, str>>, values: Vec<f64>) -> Self {
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

    /// Returns the numbers with their names; those of a note of another program have none.
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
impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            Kind::Listed(_) => f.write_str(&Self::text_of([self])),
            Kind::Foreign { text, .. } => f.write_str(text),
        }
    }
}
