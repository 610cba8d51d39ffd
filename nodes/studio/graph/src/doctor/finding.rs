//! A finding and its severity.

use serde::Serialize;
use std::fmt;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Severity {
    /// Nodes do not work together.
    Error,
    /// They may not, or not as expected.
    Warning,
    /// Information without a fault.
    Note,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Finding {
    pub(super) severity: Severity,
    /// A stable name of the kind of finding.
    pub(super) kind: &'static str,
    /// Fault and its place.
    pub(super) what: String,
    pub(super) advice: String,
}

impl Finding {
    pub(super) fn error(kind: &'static str, what: String, advice: impl Into<String>) -> Self {
        Self { severity: Severity::Error, kind, what, advice: advice.into() }
    }

    pub(super) fn warning(kind: &'static str, what: String, advice: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, kind, what, advice: advice.into() }
    }

    pub(super) fn note(kind: &'static str, what: String, advice: impl Into<String>) -> Self {
        Self { severity: Severity::Note, kind, what, advice: advice.into() }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = format!("{:?}", self.severity).to_lowercase();
        writeln!(f, "{severity}: {}", self.what)?;
        writeln!(f, "  {}", self.advice)
    }
}
