//! Which constants a model gets.

use crate::settings_error::SettingsError;
use grainlab_emt::{Calibration, Model};

/// Where the constants of the models come from.
#[derive(Clone, Debug, PartialEq)]
pub enum CalibrationChoice {
    /// To each model its own: the paper's for the paper's models, ours for those that need more.
    Default,
    /// One for all of them.
    One(Box<Calibration>),
}

impl CalibrationChoice {
    /// `default`, the name of a built-in calibration, or the text of one (TOML).
    pub fn named(text: &str) -> Result<Self, SettingsError> {
        let name = text.trim();
        if name == "default" {
            return Ok(Self::Default);
        }
        if let Some(found) = Calibration::builtin(name) {
            return Ok(Self::One(Box::new(found.clone())));
        }
        if !name.contains('=') {
            let known = ["default"].into_iter().chain(Calibration::BUILTIN).collect::<Vec<_>>().join(", ");
            return Err(SettingsError::Calibration { name: name.to_owned(), known });
        }
        match Calibration::parse(text) {
            Ok(calibration) => Ok(Self::One(Box::new(calibration))),
            Err(error) => Err(SettingsError::CalibrationText(error)),
        }
    }

    /// The constants that `model` gets.
    pub(crate) fn calibration_for(&self, model: &dyn Model) -> &Calibration {
        match self {
            Self::One(calibration) => calibration,
            Self::Default => model.default_calibration(),
        }
    }
}
