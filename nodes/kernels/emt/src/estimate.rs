//! Estimates of a model, with their uncertainty.

use crate::calibration::Calibration;
use crate::checks;
use crate::conditions::StrainRatio;
use crate::domain::{Domain, outside_fitted};
use crate::error::EmtError;
use crate::moduli::MODULI;
use crate::normal;
use crate::observation::{INPUTS, InputCovariance, Observation};
use crate::point_estimate::{Jacobian, Misfit, PointEstimate};
use crate::prior::Prior;
use crate::prior_conflict;
use crate::update::{Updated, updated};
use crate::warning::Warning;
use grainlab_core::results::{INFERENCE_INPUTS, InferredQuantity, Microstructure, MicrostructureCovariance};
use nalgebra::{SMatrix, SVector};
use std::fmt;

/// Level of the intervals of an [`Estimate`].
pub const CREDIBLE_LEVEL: f64 = 0.95;

/// Share of the variance of a quantity from which the input that causes it is named.
const WIDENS: f64 = 0.5;

/// Reliability of an estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Model and calibration were used inside their range, and the data agree with each other and with the model.
    Ok,
    /// Model or calibration were used outside their range; see the warnings.
    Extrapolated,
    /// The data contradict each other, the model or the prior; see the warnings. Takes precedence over both others.
    Contradictory,
    /// There is no estimate, or one that determines nothing.
    Unknown,
}

impl Status {
    /// Name in texts, files and results.
    pub const fn name(self) -> &'static str {
        match self {
            Status::Ok => "ok",
            Status::Extrapolated => "extrapolated",
            Status::Contradictory => "contradictory",
            Status::Unknown => "unknown",
        }
    }

    /// That of a result of a model.
    pub fn of(result: &Result<Estimate, EmtError>) -> Self {
        result.as_ref().map_or(Status::Unknown, |estimate| estimate.status)
    }

    /// Decides the status, and puts the warnings that decide it first.
    pub(crate) fn of_estimate(structure: &Microstructure, warnings: &mut [Warning]) -> Self {
        warnings.sort_by_key(|warning| match warning {
            of if of.is_contradiction() => 0,
            of if of.is_extrapolation() => 1,
            _ => 2,
        });
        if structure.values().iter().all(Option::is_none) {
            Status::Unknown
        } else if warnings.iter().any(Warning::is_contradiction) {
            Status::Contradictory
        } else if warnings.iter().any(Warning::is_extrapolation) {
            Status::Extrapolated
        } else {
            Status::Ok
        }
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Estimate of one model from one observation.
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
    /// Derivatives of the values with respect to the data.
    pub jacobian: Jacobian,
    /// Covariance from the errors of the observation; `None` if those are not known.
    pub data_covariance: Option<MicrostructureCovariance>,
    /// Covariance of the model's own error, learned from the packings of the calibration; `None` if it was not learned.
    pub model_covariance: Option<MicrostructureCovariance>,
    /// Covariance from the width of the prior; `None` without a prior.
    pub prior_covariance: Option<MicrostructureCovariance>,
    /// Misfit, where there are more data than unknowns.
    pub misfit: Option<Misfit>,
    /// Status: model and calibration inside their range or not, data in agreement or not.
    pub status: Status,
    /// Warnings about the estimate; those that decide the status come first.
    pub warnings: Vec<Warning>,
    inputs: Option<InputCovariance>,
    /// That of the model: its independent quantities, from which the others follow, and their ranges.
    domain: Domain,
    /// Central intervals that the model states; `None`: those of normal errors.
    bounds: Option<[Option<[f64; 2]>; InferredQuantity::COUNT]>,
    /// Limits of the prior of each quantity.
    limits: [[f64; 2]; InferredQuantity::COUNT],
}

impl Estimate {
    /// Covariance of the estimate: the sum of those of data, model and prior that are known; `None` if none is.
    pub fn covariance(&self) -> Option<MicrostructureCovariance> {
        let known = [self.data_covariance, self.model_covariance, self.prior_covariance];
        known.into_iter().flatten().reduce(|a, b| a + b)
    }

    /// The estimate with this prior of its quantities, all of which have a normal distribution before: exact for normal priors,
    /// and with the moments of the limited distribution for others. Quantities that the data do not determine stay so.
    pub fn with_prior(&self, prior: &Prior) -> Result<Self, EmtError> {
        let none = EmtError::NoLikelihood {
            model: self.model,
            reason: "neither the moduli nor the model have an error to weigh a prior against; give --error, or a calibration \
                     that has the error of the model",
        };
        let before = self.covariance().filter(|c| c.amax() > 0.0).ok_or(none)?;
        let values = SVector::from(self.structure.values().map(|v| v.unwrap_or(0.0)));
        let Updated { shift, covariance, kept } = updated(&values, &before, prior);
        let part = |c: Option<MicrostructureCovariance>| c.map(|c| kept * c * kept.transpose());
        let mut with = self.clone();
        with.structure = Microstructure::of_values(std::array::from_fn(|i| {
            self.structure.values()[i].map(|value| value + shift[i])
        }));
        with.bounds = None;
        with.jacobian = kept * self.jacobian;
        (with.data_covariance, with.model_covariance) =
            (part(self.data_covariance), part(self.model_covariance));
        with.prior_covariance = Some(covariance - kept * before * kept.transpose());
        for quantity in prior.quantities() {
            let Some(density) = prior.get(quantity) else { continue };
            with.limits[quantity as usize] = density.range();
        }
        with.warnings.extend(prior_conflict::warnings(&self.structure, &before, prior));
        with.decide_anew();
        Ok(with)
    }

    /// The warnings and the status that follow from the structure and its uncertainty, after these have changed.
    fn decide_anew(&mut self) {
        self.warnings.retain(|warning| !warning.is_of_structure());
        self.warnings.extend(outside_fitted(&self.domain.fitted, &self.structure));
        self.warnings.extend(checks::of_structure(&self.structure));
        let outside = outside_domain(&self.structure, &self.domain, &self.warnings);
        self.warnings.extend(outside);
        self.status = Status::of_estimate(&self.structure, &mut self.warnings);
        self.name_widest();
    }

    /// Names the input of the state that contributes most of the variance of a quantity.
    fn name_widest(&mut self) {
        if let Some((input, quantity, share)) = self.widest().filter(|(_, _, share)| *share > WIDENS) {
            self.warnings.push(Warning::WidenedMost { input, quantity, share });
        }
    }

    /// The estimate, if its structure is within the domain, that of [`crate::Model::prior_domain`]: priors of quantities that
    /// follow from others may have moved those out of it.
    pub fn within(self, domain: &Domain) -> Result<Self, EmtError> {
        for quantity in InferredQuantity::ALL {
            let range = domain.structure[quantity as usize];
            if let (Some(value), Some([low, high])) = (self.structure.get(quantity), range)
                && !(low..=high).contains(&value)
            {
                return Err(EmtError::PriorContradicts { quantity: quantity.name(), value, low, high });
            }
        }
        Ok(self)
    }

    /// The unknowns of the model that the data do not determine.
    pub fn undetermined(&self) -> impl Iterator<Item = InferredQuantity> + '_ {
        let is_open = |q: &InferredQuantity| {
            self.domain.structure[*q as usize].is_some() && self.structure.get(*q).is_none()
        };
        InferredQuantity::ALL.into_iter().filter(is_open)
    }

    /// Standard deviation of a quantity; `None` if it is undetermined or its uncertainty is not known.
    pub fn stddev(&self, quantity: InferredQuantity) -> Option<f64> {
        self.structure.get(quantity)?;
        let i = quantity as usize;
        Some(self.covariance()?[(i, i)].max(0.0).sqrt())
    }

    /// Central interval of a quantity at [`CREDIBLE_LEVEL`], low and high: that of the model, else for normal errors, within the
    /// limits of its prior.
    pub fn interval(&self, quantity: InferredQuantity) -> Option<[f64; 2]> {
        if let Some(bounds) = &self.bounds {
            return bounds[quantity as usize];
        }
        let middle = self.structure.get(quantity)?;
        let half = normal::HALF_WIDTH * self.stddev(quantity)?;
        let [low, high] = self.limits[quantity as usize];
        Some([(middle - half).max(low), (middle + half).min(high)])
    }

    /// The input of the state that contributes most to the variance of a quantity: its name, the quantity, and its share of the
    /// whole variance, from 0 to 1. `None` where the state has no error.
    pub fn widest(&self) -> Option<(&'static str, InferredQuantity, f64)> {
        let (inputs, total) = (self.inputs?, self.covariance()?);
        let of = |quantity: InferredQuantity| {
            let i = quantity as usize;
            self.structure.get(quantity).filter(|_| total[(i, i)] > 0.0)?;
            let share = |j: usize| self.jacobian[(i, j)].powi(2) * inputs[(j, j)] / total[(i, i)];
            let widest = (MODULI..INPUTS).max_by(|a, b| share(*a).total_cmp(&share(*b)))?;
            Some((INFERENCE_INPUTS[widest], quantity, share(widest)))
        };
        let all = InferredQuantity::ALL.into_iter().filter_map(of);
        all.max_by(|a, b| a.2.total_cmp(&b.2)).filter(|(_, _, share)| *share > 0.0)
    }

    /// Condition number: ratio of the largest to the smallest singular value of the Jacobian of the model's unknowns,
    /// with relative changes for coordination numbers. It compares how strongly errors of the data act on different
    /// combinations.
    pub fn condition_number(&self) -> Option<f64> {
        let mut scaled = SMatrix::<f64, { InferredQuantity::COUNT }, INPUTS>::zeros();
        let mut determined = 0;
        for (i, quantity) in InferredQuantity::ALL.into_iter().enumerate() {
            let Some(value) = self.structure.get(quantity).filter(|_| self.domain.structure[i].is_some())
            else {
                continue;
            };
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
    /// order of [`INFERENCE_INPUTS`]. Correlated errors divide their covariance equally, so that a fraction may be
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
    let PointEstimate { structure, discrepancy, bounds, misfit, mut warnings, .. } = point;
    let inputs = observation.input_covariance(calibration.material());
    // The error of the data is not known where only errors of the state are known and the model does not use it.
    let data_covariance = inputs
        .map(|input| jacobian * input * jacobian.transpose())
        .filter(|c| observation.covariance.is_some() || c.amax() > 0.0);
    let inputs = inputs.filter(|_| data_covariance.is_some());
    let gamma = observation.conditions.gamma;
    let model_covariance = discrepancy.or_else(|| {
        calibration.discrepancy(model, uses_gamma.then_some(gamma.source), &structure, observation.grains)
    });
    let model_covariance = model_covariance.map(|c| of_determined(c, &structure));
    // Finite inputs of extreme scale can still overflow.
    let values = structure.values();
    let covariance = data_covariance.into_iter().chain(model_covariance).reduce(|a, b| a + b);
    for value in values.iter().flatten().chain(covariance.iter().flatten()) {
        if !value.is_finite() {
            return Err(EmtError::NotFinite { quantity: "the estimate", value: *value });
        }
    }
    domain.validate_solid_fraction(&observation.conditions)?;
    checks::check_inferred(&structure)?;
    warnings.extend(checks::common(observation, calibration, uses_gamma, domain));
    warnings.extend(checks::of_structure(&structure));
    warnings.extend(outside_domain(&structure, domain, &warnings));
    warnings.extend(undetermined(&structure, domain));
    let status = Status::of_estimate(&structure, &mut warnings);
    let mut estimate = Estimate {
        model,
        calibration: calibration.name().to_owned(),
        gamma: uses_gamma.then_some(gamma),
        structure,
        jacobian,
        data_covariance,
        model_covariance,
        prior_covariance: None,
        misfit,
        status,
        warnings,
        inputs,
        domain: *domain,
        bounds,
        limits: [[f64::NEG_INFINITY, f64::INFINITY]; InferredQuantity::COUNT],
    };
    if observation.covariance.is_none() && estimate.covariance().is_some() {
        estimate.warnings.push(Warning::DataErrorUnknown);
    }
    estimate.name_widest();
    Ok(estimate)
}

/// The unknowns of the model that are outside its domain, unless another warning says so.
fn outside_domain(structure: &Microstructure, domain: &Domain, warnings: &[Warning]) -> Vec<Warning> {
    if warnings.iter().any(Warning::is_extrapolation) {
        return Vec::new();
    }
    let of = |quantity: InferredQuantity| {
        let (value, range) = structure.get(quantity).zip(domain.structure[quantity as usize])?;
        let outside = !(range[0]..=range[1]).contains(&value);
        outside.then_some(Warning::OutsideDomain { quantity, value, range })
    };
    InferredQuantity::ALL.into_iter().filter_map(of).collect()
}

/// The unknowns of the model that are open.
fn undetermined(structure: &Microstructure, domain: &Domain) -> Option<Warning> {
    let quantities =
        InferredQuantity::ALL.map(|q| structure.get(q).is_none() && domain.structure[q as usize].is_some());
    quantities.contains(&true).then_some(Warning::Undetermined { quantities })
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
