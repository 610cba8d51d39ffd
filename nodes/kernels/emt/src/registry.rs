//! The list of the models.

use crate::model::Model;
use crate::models::directional::Directional;
use crate::models::effective_medium::EffectiveMedium;
use crate::models::ratio;
use crate::models::relaxed::Relaxed;
use crate::models::unequal_springs;

/// Every model, in the order of every list of results.
pub fn models() -> &'static [&'static dyn Model] {
    &[
        &EffectiveMedium,
        &ratio::CORRECTED,
        &ratio::AS_PRINTED,
        &ratio::FIXED_VOLUME,
        &unequal_springs::LINEAR,
        &unequal_springs::NONLINEAR,
        &Directional,
        &Relaxed,
    ]
}

/// The model of this name.
pub fn model(name: &str) -> Option<&'static dyn Model> {
    models().iter().copied().find(|m| m.name() == name)
}
