//! The trait of all models.

use crate::calibration::Calibration;
use crate::conditions::Conditions;
use crate::domain::Domain;
use crate::error::EmtError;
use crate::estimate::{Inversion, assemble};
use crate::estimate_likelihood::OfEstimate;
use crate::likelihood::Likelihood;
use crate::moduli::Moduli;
use crate::observation::Observation;
use crate::point_estimate::PointEstimate;
use crate::propagation::numerical_jacobian;
use grainlab_core::results::{InferredQuantity, Microstructure};
use std::fmt::Debug;

/// A theory that relates microstructure to moduli. A new one is a file in `models` with this trait and a line in
/// [`models`](fn@crate::models).
pub trait Model: Sync + Debug {
    /// Name on command lines, in messages and in results.
    fn name(&self) -> &'static str;

    /// True if the model uses γ/Δ.
    fn uses_gamma(&self) -> bool {
        false
    }

    /// True if the model uses the learned constants of a calibration, not its material alone.
    fn uses_constants(&self) -> bool {
        true
    }

    /// The structures and states for which [`Model::predict`] is one to one.
    fn domain(&self, calibration: &Calibration) -> Domain;

    /// The calibration to use when none is given: the paper's constants where they suffice, else `grainlab`.
    fn default_calibration(&self) -> &'static Calibration {
        static PAPER: Calibration = Calibration::PAPER;
        let needs_more = self.domain(&PAPER).structure.iter().all(Option::is_none);
        needs_more.then(|| Calibration::builtin("grainlab")).flatten().unwrap_or(&PAPER)
    }

    /// The moduli of a packing of this structure in this state; `None` for those that the model does not predict.
    fn predict(
        &self,
        structure: &Microstructure,
        conditions: &Conditions,
        calibration: &Calibration,
    ) -> Result<Moduli, EmtError>;

    /// The structure whose prediction equals this observation or is closest to it; `None` for quantities that
    /// the known moduli do not determine. The observation comes from [`Observation::checked`].
    fn solve(&self, observation: &Observation, calibration: &Calibration) -> Result<PointEstimate, EmtError>;

    /// The structure with its uncertainty.
    fn infer(&self, observation: &Observation, calibration: &Calibration) -> Result<Inversion, EmtError> {
        let observation = observation.checked()?;
        self.domain(calibration).validate_contact(&observation.conditions)?;
        let mut point = self.solve(&observation, calibration)?;
        let jacobian = point.jacobian.take().unwrap_or_else(|| {
            numerical_jacobian(&observation, &point.structure, calibration.material(), |o| {
                self.solve(o, calibration).map(|p| p.structure)
            })
        });
        assemble(
            self.name(),
            self.uses_gamma(),
            &self.domain(calibration),
            &observation,
            calibration,
            point,
            jacobian,
        )
    }

    /// The quantities that it infers.
    fn quantities(&self, calibration: &Calibration) -> Vec<InferredQuantity> {
        let domain = self.domain(calibration);
        InferredQuantity::ALL.into_iter().filter(|q| domain.structure[*q as usize].is_some()).collect()
    }

    /// The range of the structures for which [`Model::likelihood`] is stated.
    fn prior_domain(&self, calibration: &Calibration) -> Domain {
        self.domain(calibration)
    }

    /// The probability of the observed moduli. By default that of the error of the inferred unknowns, where there are as many
    /// moduli as unknowns.
    fn likelihood<'a>(
        &'a self,
        observation: &Observation,
        calibration: &'a Calibration,
    ) -> Result<Box<dyn Likelihood + 'a>, EmtError> {
        let estimate = self.infer(observation, calibration)?;
        Ok(Box::new(OfEstimate::new(&estimate, &observation.checked()?)?))
    }
}

/// Names identify models.
impl PartialEq for dyn Model {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}
