//! What a model is, and the list of them.

use crate::calibration::Calibration;
use crate::error::EmtError;
use crate::estimate::{Estimate, Structure};
use crate::observation::{Gamma, Observation};
use crate::ratio;

/// A theory that ties microstructure to moduli. A new one is a file with this trait and a line in [`models`].
pub trait Model: Sync {
    /// Its name on command lines, in messages and in results.
    fn name(&self) -> &'static str;

    /// What a packing of this structure is observed to have at `pressure`, Pa.
    fn predict(
        &self,
        structure: &Structure,
        gamma: Gamma,
        pressure: f64,
        calibration: &Calibration,
    ) -> Observation;

    /// The structure of which [`Model::predict`] gives this observation.
    fn infer(&self, observation: &Observation, calibration: &Calibration) -> Result<Estimate, EmtError>;
}

/// Every model, in the order of every list of results.
pub fn models() -> &'static [&'static dyn Model] {
    &[&ratio::CORRECTED, &ratio::AS_PRINTED]
}

/// The model of this name.
pub fn model(name: &str) -> Option<&'static dyn Model> {
    models().iter().copied().find(|m| m.name() == name)
}

/// What every model infers, by name, in the order of [`models`].
pub fn infer_all(
    observation: &Observation,
    calibration: &Calibration,
) -> Vec<(&'static str, Result<Estimate, EmtError>)> {
    models().iter().map(|m| (m.name(), m.infer(observation, calibration))).collect()
}
