//! What a model infers, with its uncertainty.

use crate::calibration::Calibration;
use crate::checks;
use crate::conditions::StrainRatio;
use crate::domain::Domain;
use crate::error::EmtError;
use crate::observation::{INPUTS, InputCovariance, Observation};
use crate::point_estimate::{Jacobian, Misfit, PointEstimate};
use crate::warning::Warning;
use grainlab_core::results::{InferredQuantity, Microstructure, MicrostructureCovariance};
use nalgebra::SMatrix;

/// Level of the intervals of an [`Estimate`].
pub const CREDIBLE_LEVEL: f64 = 0.95;

/// Half width, in standard deviations, of the central interval of a normal distribution at [`CREDIBLE_LEVEL`].
pub(crate) const HALF_WIDTH: f64 = 1.959_963_984_540_054;

/// Whether an estimate lies in the range of its model and calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Inside.
    Ok,
    /// Outside; see the warnings.
    Extrapolated,
}

/// What one model infers from one observation.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Name of the model.
    pub model: &'static str,
    /// Name of the calibration.
    pub calibration: String,
    /// The γ/Δ given to the model; `None` if it uses none.
    pub gamma: Option<StrainRatio>,
    /// The most probable values; `None` is undetermined, or not part of the model.
    pub structure: Microstructure,
    /// Their derivatives with respect to the data.
    pub jacobian: Jacobian,
    /// Covariance from the errors of the observation; `None` if those are not known.
    pub data_covariance: Option<MicrostructureCovariance>,
    /// Covariance of the model's own error, learned from the packings of the calibration; `None` if it was not learned.
    pub model_covariance: Option<MicrostructureCovariance>,
    /// Misfit, where there are more data than unknowns.
    pub misfit: Option<Misfit>,
    /// Whether model and calibration were used inside their range.
    pub status: Status,
    /// Warnings.
    pub warnings: Vec<Warning>,
    inputs: Option<InputCovariance>,
    /// The independent quantities of the model; the others follow from them.
    unknowns: [bool; InferredQuantity::COUNT],
}

impl Estimate {
    /// Covariance of the estimate: the sum of those of data and model that are known; `None` if neither is.
    pub fn covariance(&self) -> Option<MicrostructureCovariance> {
        match (self.data_covariance, self.model_covariance) {
            (None, None) => None,
            (data, model) => Some(data.unwrap_or_default() + model.unwrap_or_default()),
        }
    }

    /// The unknowns of the model that the data do not determine.
    pub fn undetermined(&self) -> impl Iterator<Item = InferredQuantity> + '_ {
        let is_open = |q: &InferredQuantity| self.unknowns[*q as usize] && self.structure.get(*q).is_none();
        InferredQuantity::ALL.into_iter().filter(is_open)
    }

    /// Standard deviation of a quantity; `None` if it is undetermined or its uncertainty is not known.
    pub fn stddev(&self, quantity: InferredQuantity) -> Option<f64> {
        self.structure.get(quantity)?;
        let i = quantity as usize;
        Some(self.covariance()?[(i, i)].max(0.0).sqrt())
    }

    /// Central interval of a quantity at [`CREDIBLE_LEVEL`], low and high, for normal errors.
    pub fn interval(&self, quantity: InferredQuantity) -> Option<[f64; 2]> {
        let middle = self.structure.get(quantity)?;
        let half = HALF_WIDTH * self.stddev(quantity)?;
        Some([middle - half, middle + half])
    }

    /// Condition number: ratio of the largest to the smallest singular value of the Jacobian of the model's unknowns,
    /// with relative changes for coordination numbers. It compares how strongly errors of the data act on different
    /// combinations.
    pub fn condition_number(&self) -> Option<f64> {
        let mut scaled = SMatrix::<f64, { InferredQuantity::COUNT }, INPUTS>::zeros();
        let mut determined = 0;
        for (i, quantity) in InferredQuantity::ALL.into_iter().enumerate() {
            let Some(value) = self.structure.get(quantity).filter(|_| self.unknowns[i]) else { continue };
            let scale = if quantity.is_coordination() { 1.0 / value } else { 1.0 };
            scaled.set_row(determined, &(self.jacobian.row(i) * scale));
            determined += 1;
        }
        let mut singular: Vec<f64> =
            (scaled * scaled.transpose()).symmetric_eigenvalues().iter().map(|v| v.max(0.0).sqrt()).collect();
        singular.sort_by(f64::total_cmp);
        let largest = *singular.last().filter(|v| **v > 0.0)?;
        let smallest = singular.into_iter().find(|v| *v > 1e-6 * largest)?;
        Some(largest / smallest)
    }

    /// Contribution of each input to the variance of a quantity from the errors of the data, as fractions of it, in the
    /// order of [`crate::INPUT_NAMES`]. Correlated errors divide their covariance equally, so that a fraction may be
    /// negative. Where the errors are not known, all inputs are given the same relative error. `None` if the quantity
    /// is undetermined.
    pub fn information(&self, quantity: InferredQuantity) -> Option<[f64; INPUTS]> {
        self.structure.get(quantity)?;
        let row = self.jacobian.row(quantity as usize);
        let inputs = self.inputs.filter(|c| c.amax() > 0.0).unwrap_or_else(InputCovariance::identity);
        let with_all = row * inputs;
        let parts: [f64; INPUTS] = std::array::from_fn(|i| row[i] * with_all[i]);
        let total: f64 = parts.iter().sum();
        (total > 0.0).then(|| parts.map(|p| p / total))
    }
}

/// Propagates the errors of a point estimate and adds the warnings.
pub(crate) fn assemble(
    model: &'static str,
    uses_gamma: bool,
    domain: &Domain,
    observation: &Observation,
    calibration: &Calibration,
    point: PointEstimate,
    jacobian: Jacobian,
) -> Result<Estimate, EmtError> {
    let PointEstimate { structure, discrepancy, misfit, mut warnings, .. } = point;
    let inputs = observation.input_covariance();
    let data_covariance = inputs.map(|input| jacobian * input * jacobian.transpose());
    let gamma = observation.conditions.gamma;
    let model_covariance = discrepancy
        .or_else(|| calibration.discrepancy(model, uses_gamma.then_some(gamma.source), structure.eps));
    let model_covariance = model_covariance.map(|c| of_determined(c, &structure));
    // Finite inputs of extreme scale can still overflow.
    let values = structure.values();
    for value in values.iter().flatten().chain(data_covariance.iter().flatten()) {
        if !value.is_finite() {
            return Err(EmtError::NotFinite { quantity: "the estimate", value: *value });
        }
    }
    warnings.extend(checks::common(observation, &structure, calibration, uses_gamma, domain.compares_state));
    let extrapolated = warnings.iter().any(Warning::is_extrapolation) || !domain.contains(&structure);
    Ok(Estimate {
        model,
        calibration: calibration.name().to_owned(),
        gamma: uses_gamma.then_some(gamma),
        structure,
        jacobian,
        data_covariance,
        model_covariance,
        misfit,
        status: if extrapolated { Status::Extrapolated } else { Status::Ok },
        warnings,
        inputs,
        unknowns: domain.structure.map(|range| range.is_some()),
    })
}

fn of_determined(
    mut covariance: MicrostructureCovariance,
    structure: &Microstructure,
) -> MicrostructureCovariance {
    for (i, value) in structure.values().iter().enumerate() {
        if value.is_none() {
            covariance.fill_row(i, 0.0);
            covariance.fill_column(i, 0.0);
        }
    }
    covariance
}
