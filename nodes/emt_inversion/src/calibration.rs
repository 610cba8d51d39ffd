//! Which constants a model gets.

use crate::settings::{Settings, SettingsError};
use emt::{Calibration, Model};

/// Where the constants of the models come from.
#[derive(Clone, Debug, PartialEq)]
pub enum CalibrationChoice {
    /// To each model its own.
    Default,
    /// One for all of them.
    One(Calibration),
}

impl CalibrationChoice {
    /// `default`, the name of a calibration, or the whole text of one (TOML).
    pub fn named(text: &str) -> Result<Self, SettingsError> {
        let name = text.trim();
        if name == "default" {
            return Ok(Self::Default);
        }
        if let Some(builtin) = Calibration::builtin(name) {
            return Ok(Self::One(builtin.clone()));
        }
        // A name has no line break; whatever has one is meant as the text itself.
        if name.contains('\n') {
            let parsed = Calibration::parse(text);
            return parsed.map(Self::One).map_err(|error| SettingsError::CalibrationText { error });
        }
        let known = ["default"].into_iter().chain(Calibration::BUILTIN).collect::<Vec<_>>().join(", ");
        Err(SettingsError::Calibration { name: text.to_owned(), known })
    }
}

/// The constants that `model` gets.
pub(crate) fn calibration_for<'a>(model: &dyn Model, settings: &'a Settings) -> &'a Calibration {
    match &settings.calibration {
        CalibrationChoice::One(calibration) => calibration,
        CalibrationChoice::Default => Calibration::default_for(model),
    }
}
