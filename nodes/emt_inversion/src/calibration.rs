//! Which constants a model gets.

use crate::settings::SettingsError;
use emt::{Calibration, Model};
use std::sync::{Arc, LazyLock};

/// Where the constants of the models come from.
#[derive(Clone, Debug, PartialEq)]
pub enum CalibrationChoice {
    /// To each model its own: the paper's for the paper's models, for the others the first built-in one that has theirs.
    Default,
    /// One for all of them.
    One(Arc<Calibration>),
}

/// Those of [`Calibration::BUILTIN`].
static BUILTIN: LazyLock<Vec<Arc<Calibration>>> = LazyLock::new(|| {
    Calibration::BUILTIN.iter().filter_map(|n| Calibration::builtin(n)).map(Arc::new).collect()
});

impl CalibrationChoice {
    /// `default`, the name of a built-in calibration, or the text of one (TOML).
    pub fn named(text: &str) -> Result<Self, SettingsError> {
        let name = text.trim();
        if name == "default" {
            return Ok(Self::Default);
        }
        if let Some(found) = BUILTIN.iter().find(|c| c.name() == name) {
            return Ok(Self::One(Arc::clone(found)));
        }
        if !name.contains('=') {
            let known = ["default"].into_iter().chain(Calibration::BUILTIN).collect::<Vec<_>>().join(", ");
            return Err(SettingsError::Calibration { name: name.to_owned(), known });
        }
        match Calibration::parse(text) {
            Ok(calibration) => Ok(Self::One(Arc::new(calibration))),
            Err(error) => Err(SettingsError::CalibrationText(error)),
        }
    }

    /// The constants that `model` gets.
    pub(crate) fn calibration_for(&self, model: &dyn Model) -> Arc<Calibration> {
        let of_model = |c: &&Arc<Calibration>| model.domain(c).structure.iter().any(Option::is_some);
        match self {
            Self::One(calibration) => Arc::clone(calibration),
            // The paper's is the first of the built-in ones.
            Self::Default => match BUILTIN.iter().find(of_model) {
                Some(own) => Arc::clone(own),
                None => Arc::new(Calibration::PAPER),
            },
        }
    }
}
