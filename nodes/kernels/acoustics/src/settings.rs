//! Settings of a measurement.

use crate::error::{AcousticsError, setting};
use crate::instrument::Instrument;
use crate::survey::{Modes, Survey};
use crate::{dispersion, time_of_flight};
use grainlab_core::Vec3;

/// A method of measuring speeds, with its settings.
#[derive(Clone, Debug, PartialEq)]
pub enum MethodSettings {
    /// Method of the module [`dispersion`].
    Dispersion(dispersion::Settings),
    /// Method of the module [`time_of_flight`].
    TimeOfFlight(time_of_flight::Settings),
}

/// Settings of a measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Method of measuring speeds.
    pub method: MethodSettings,
    /// Unit axis of symmetry, if it is known.
    pub axis: Option<Vec3>,
    /// Set of rays; [`Survey::Hemisphere`] without an axis.
    pub survey: Survey,
    /// Polarizations sent along them.
    pub modes: Modes,
    /// Source, receivers, electronics.
    pub instrument: Instrument,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: MethodSettings::Dispersion(dispersion::Settings::default()),
            axis: Some(Vec3::z()),
            survey: Survey::default(),
            modes: Modes::default(),
            instrument: Instrument::default(),
        }
    }
}

impl Settings {
    pub(crate) fn check(&self) -> Result<(), AcousticsError> {
        if let Some(axis) = self.axis {
            let value = axis.norm();
            setting("|axis|", value, value.is_finite() && value > 0.0, "a direction: finite and not zero")?;
        }
        self.instrument.validated().map(|_| ())
    }
}
