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
    /// `default`, or the name of a calibration.
    pub fn named(text: &str) -> Result<Self, SettingsError> {
        match text.trim() {
            "default" => Ok(Self::Default),
            "paper" => Ok(Self::One(Calibration::PAPER)),
            _ => Err(SettingsError::Calibration { name: text.to_owned(), known: "default, paper" }),
        }
    }
}

/// The constants that `model` gets. The paper's models have the paper's for their own.
pub(crate) fn calibration_for(_model: &dyn Model, settings: &Settings) -> Calibration {
    match &settings.calibration {
        CalibrationChoice::One(calibration) => calibration.clone(),
        CalibrationChoice::Default => Calibration::PAPER,
    }
}
