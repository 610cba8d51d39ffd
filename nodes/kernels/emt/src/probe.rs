//! What is known of the probe that measured the moduli.

use std::fmt;
use std::str::FromStr;

/// Standard deviations of z, ε and k that an unknown probe adds: the rms errors of the 16 rows of the paper's Table III, whose moduli are
/// lower than those of any network without sliding contacts. `tests/ensembles` of `grainlab_calibration` fits them.
pub(crate) const UNKNOWN_PROBE: ProbeErrors = ProbeErrors { z: 0.19, eps: 0.040, k: 0.43 };

/// Standard deviations that a probe adds to those of the model and of the data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeErrors {
    /// Of the coordination number without rattlers.
    pub z: f64,
    /// Of the contact anisotropy.
    pub eps: f64,
    /// Of the coordination number of all grains.
    pub k: f64,
}

/// Whether contacts slid while the moduli were measured.
///
/// The models describe a network whose contacts stick. Contacts that slide lower the moduli, and a sample then looks like one with fewer
/// contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Probe {
    /// No contact slid: the stiffness of a frozen network, elastic waves, or a small strain at high friction.
    #[default]
    Sticking,
    /// Contacts may have slid.
    Unknown,
}

impl Probe {
    /// Every probe.
    pub const ALL: [Self; 2] = [Self::Sticking, Self::Unknown];

    /// Returns the name in flags, tables and parameters.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sticking => "sticking",
            Self::Unknown => "unknown",
        }
    }

    /// Returns the standard deviations that this probe adds; `None` if it adds none.
    pub fn errors(self) -> Option<&'static ProbeErrors> {
        (self == Self::Unknown).then_some(&UNKNOWN_PROBE)
    }
}

impl fmt::Display for Probe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The name of no probe.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no probe {0:?}; give sticking if no contact slid while the moduli were measured, else unknown")]
pub struct NoProbe(String);

impl FromStr for Probe {
    type Err = NoProbe;

    fn from_str(text: &str) -> Result<Self, NoProbe> {
        Self::ALL.into_iter().find(|probe| probe.name() == text).ok_or_else(|| NoProbe(text.to_owned()))
    }
}
