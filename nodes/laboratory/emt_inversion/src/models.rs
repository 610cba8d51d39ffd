//! The models to apply.

use crate::settings_error::SettingsError;
use grainlab_emt::Model;

/// Models, each once, in the order of [`grainlab_emt::models`].
#[derive(Clone, Debug)]
pub struct Models(Vec<&'static dyn Model>);

impl Models {
    /// All models.
    pub fn all() -> Self {
        Self(grainlab_emt::models().to_vec())
    }

    /// `all`, or comma-separated names in any order.
    pub fn named(text: &str) -> Result<Self, SettingsError> {
        if text.trim() == "all" {
            return Ok(Self::all());
        }
        let names: Vec<&str> = text.split(',').map(str::trim).collect();
        if let Some(stranger) = names.iter().find(|n| grainlab_emt::model(n).is_none()) {
            let known: Vec<&str> = grainlab_emt::models().iter().map(|m| m.name()).collect();
            let (name, known) = ((*stranger).to_owned(), known.join(", "));
            return Err(SettingsError::Model { name, known });
        }
        Ok(Self(grainlab_emt::models().iter().copied().filter(|m| names.contains(&m.name())).collect()))
    }

    /// The models, in order.
    pub fn iter(&self) -> impl Iterator<Item = &'static dyn Model> + '_ {
        self.0.iter().copied()
    }
}

/// Compares names, which identify the models.
impl PartialEq for Models {
    fn eq(&self, other: &Self) -> bool {
        self.iter().map(Model::name).eq(other.iter().map(Model::name))
    }
}
