//! The status of an estimate.

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
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
