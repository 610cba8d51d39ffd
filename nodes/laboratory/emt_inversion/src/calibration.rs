//! The constants of each model.

use crate::settings_error::SettingsError;
use grainlab_emt::{Calibration, Model};

/// Source of the constants of the models.
#[derive(Clone, Debug, PartialEq)]
pub enum CalibrationChoice {
    /// Each model has its own default: the paper's constants for the paper's models, the built-in ones for
    /// the others.
    Default,
    /// One calibration for all models.
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

    /// The constants of `model`.
    pub(crate) fn calibration_for(&self, model: &dyn Model) -> &Calibration {
        match self {
            Self::One(calibration) => calibration,
            Self::Default => model.default_calibration(),
        }
    }
}
