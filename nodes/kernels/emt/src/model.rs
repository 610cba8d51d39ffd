//! What a model is, and the list of them.

use crate::calibration::Calibration;
use crate::conditions::Conditions;
use crate::directional::Directional;
use crate::domain::Domain;
use crate::error::EmtError;
use crate::estimate::{Estimate, assemble};
use crate::moduli::Moduli;
use crate::observation::{INPUTS, Observation};
use crate::propagation::numerical_slopes;
use crate::relaxed::Relaxed;
use crate::structure::{QUANTITIES, Structure, StructureCovariance};
use crate::warning::Warning;
use crate::{effective, full, ratio, sqrt};
use nalgebra::SMatrix;
use std::fmt::Debug;

/// Change of each quantity per relative change of each input (of γ/Δ: per change): rows as [`crate::Quantity::ALL`],
/// columns as [`crate::INPUT_NAMES`].
pub type Slopes = SMatrix<f64, QUANTITIES, INPUTS>;

/// A point estimate, and what only the model can say about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The structure.
    pub structure: Structure,
    /// How it depends on the inputs; `None` leaves it to central differences of [`Model::solve`].
    pub slopes: Option<Slopes>,
    /// Covariance of what the model leaves out, where it differs from what the calibration has learned for the model as a
    /// whole.
    pub discrepancy: Option<StructureCovariance>,
    /// Misfit of more data than unknowns.
    pub misfit: Option<Misfit>,
    /// What to keep in mind, beyond what holds for every model.
    pub warnings: Vec<Warning>,
}

impl Solution {
    /// A structure that fits exactly, with nothing to add.
    pub const fn exact(structure: Structure) -> Self {
        Self { structure, slopes: None, discrepancy: None, misfit: None, warnings: Vec::new() }
    }
}

/// How far more data than unknowns are from any structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit {
    /// Weighted sum of squares, by errors of data and model.
    pub chi_square: f64,
    /// Data less unknowns.
    pub degrees_of_freedom: usize,
}

/// A theory that ties microstructure to moduli. A new one is a file with this trait and a line in [`models`].
pub trait Model: Sync + Debug {
    /// Its name on command lines, in messages and in results.
    fn name(&self) -> &'static str;

    /// Whether γ/Δ enters.
    fn uses_gamma(&self) -> bool {
        true
    }

    /// The structures and states that [`Model::predict`] is one to one for.
    fn domain(&self, calibration: &Calibration) -> Domain;

    /// The moduli of a packing of this structure in this state; those that the model has no word on are `None`.
    fn predict(
        &self,
        structure: &Structure,
        conditions: &Conditions,
        calibration: &Calibration,
    ) -> Result<Moduli, EmtError>;

    /// The structure that [`Model::predict`] gives this observation for, or comes nearest to it; what the moduli known
    /// do not determine is `None`. The observation comes from [`Observation::checked`].
    fn solve(&self, observation: &Observation, calibration: &Calibration) -> Result<Solution, EmtError>;

    /// The structure with its uncertainty.
    fn infer(&self, observation: &Observation, calibration: &Calibration) -> Result<Estimate, EmtError> {
        let observation = observation.checked()?;
        let mut solution = self.solve(&observation, calibration)?;
        let slopes = solution.slopes.take().unwrap_or_else(|| {
            numerical_slopes(&observation, &solution.structure, |o| {
                self.solve(o, calibration).map(|s| s.structure)
            })
        });
        assemble(
            self.name(),
            self.uses_gamma(),
            &self.domain(calibration),
            &observation,
            calibration,
            solution,
            slopes,
        )
    }
}

/// Every model, in the order of every list of results.
pub fn models() -> &'static [&'static dyn Model] {
    &[
        &effective::Effective,
        &ratio::CORRECTED,
        &ratio::AS_PRINTED,
        &ratio::VOLUME,
        &full::LINEAR,
        &sqrt::SQRT,
        &Directional,
        &Relaxed,
    ]
}

/// The model of this name.
pub fn model(name: &str) -> Option<&'static dyn Model> {
    models().iter().copied().find(|m| m.name() == name)
}
