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
use grainlab_core::notes::{Code, Note, Status};
use grainlab_core::results::{
    Estimate, GammaUsed, INFERENCE_INPUTS, InferredQuantity, Interval, Microstructure,
    MicrostructureCovariance, Quantities,
};
use nalgebra::{SMatrix, SVector};

/// Level of the intervals of an [`Estimate`].
pub const CREDIBLE_LEVEL: f64 = 0.95;

/// Notes that follow from the structure and its uncertainty alone, which a prior changes.
const OF_STRUCTURE: [Code; 8] = [
    Code::BelowCalibration,
    Code::AboveCalibration,
    Code::AnisotropyOutsideCalibration,
    Code::CoordinationImpossible,
    Code::CoordinationAbsurd,
    Code::EpsOutOfRange,
    Code::OutsideDomain,
    Code::WidenedMost,
];

/// Share of the variance of a quantity from which the input that causes it is named.
const WIDENS: f64 = 0.5;

/// The inversion of one observation by one model: an estimate, and what it depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Inversion {
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
    /// Limitations and contradictions; those that decide the status come first.
    pub notes: Vec<Note>,
    inputs: Option<InputCovariance>,
    /// That of the model: its independent quantities, from which the others follow, and their ranges.
    domain: Domain,
    /// Central intervals that the model states; `None`: those of normal errors.
    bounds: Option<[Option<[f64; 2]>; InferredQuantity::COUNT]>,
    limits: [[f64; 2]; InferredQuantity::COUNT],
}

impl Inversion {
    /// Returns the result, without what only this model can use.
    pub fn estimate(&self) -> Estimate {
        // A covariance of zeros contains no information.
        let known = |covariance: Option<MicrostructureCovariance>| covariance.filter(|c| c.amax() > 0.0);
        let covariance = known(self.covariance());
        Estimate {
            model: self.model.to_owned(),
            calibration: self.calibration.clone(),
            values: Quantities(self.structure.values()),
            covariance,
            covariance_model: known(self.model_covariance),
            interval: Interval {
                level: covariance.map(|_| CREDIBLE_LEVEL),
                bounds: Quantities::from_fn(|q| self.interval(q).filter(|_| covariance.is_some())),
            },
            chi_square: self.misfit.map(|m| m.chi_square),
            degrees_of_freedom: Some(self.misfit.map_or(0, |m| m.degrees_of_freedom)),
            condition_number: self.condition_number(),
            information: Quantities::from_fn(|q| self.information(q)),
            gamma: self.gamma.map(|g| GammaUsed { value: g.value, source: g.source.name() }),
            status: self.status(),
            notes: self.notes.clone(),
        }
    }

    /// Returns the reliability of the estimate.
    pub fn status(&self) -> Status {
        Status::of(&self.notes)
    }

    /// Adds a note; those with the worst status come first.
    pub(crate) fn add(&mut self, note: Note) {
        self.notes.push(note);
        by_severity(&mut self.notes);
    }

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
        with.notes.retain(|note| !OF_STRUCTURE.iter().any(|code| note.is(*code)));
        with.notes.extend(outside_fitted(&with.domain.fitted, &with.structure));
        with.notes.extend(checks::of_structure(&with.structure));
        let outside = outside_domain(&with.structure, &with.domain, &with.notes);
        with.notes.extend(outside);
        with.notes.extend(prior_conflict::notes(&self.structure, &before, prior));
        by_severity(&mut with.notes);
        with.name_widest();
        Ok(with)
    }

    /// Names the input of the state that contributes most of the variance of a quantity.
    fn name_widest(&mut self) {
        if let Some((input, quantity, share)) = self.widest().filter(|(_, _, share)| *share > WIDENS) {
            self.notes.push(Note::widened_most(input, quantity.name(), share));
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

/// Propagates the errors of a point estimate and adds the notes.
pub(crate) fn assemble(
    model: &'static str,
    uses_gamma: bool,
    domain: &Domain,
    observation: &Observation,
    calibration: &Calibration,
    point: PointEstimate,
    jacobian: Jacobian,
) -> Result<Inversion, EmtError> {
    let PointEstimate { structure, discrepancy, bounds, misfit, mut notes, .. } = point;
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
    notes.extend(checks::common(observation, calibration, uses_gamma, domain));
    notes.extend(checks::of_structure(&structure));
    notes.extend(outside_domain(&structure, domain, &notes));
    notes.extend(undetermined(&structure, domain));
    by_severity(&mut notes);
    let mut inversion = Inversion {
        model,
        calibration: calibration.name().to_owned(),
        gamma: uses_gamma.then_some(gamma),
        structure,
        jacobian,
        data_covariance,
        model_covariance,
        prior_covariance: None,
        misfit,
        notes,
        inputs,
        domain: *domain,
        bounds,
        limits: [[f64::NEG_INFINITY, f64::INFINITY]; InferredQuantity::COUNT],
    };
    if observation.covariance.is_none() && inversion.covariance().is_some() {
        inversion.notes.push(Note::data_error_unknown());
    }
    inversion.name_widest();
    Ok(inversion)
}

fn by_severity(notes: &mut [Note]) {
    notes.sort_by_key(|note| std::cmp::Reverse(note.severity()));
}

/// The unknowns of the model that are outside its domain, unless another note says so.
fn outside_domain(structure: &Microstructure, domain: &Domain, notes: &[Note]) -> Vec<Note> {
    if Status::of(notes) > Status::Ok {
        return Vec::new();
    }
    let of = |quantity: InferredQuantity| {
        let (value, range) = structure.get(quantity).zip(domain.structure[quantity as usize])?;
        let outside = !(range[0]..=range[1]).contains(&value);
        outside.then(|| Note::outside_domain(quantity.name(), value, range[0], range[1]))
    };
    InferredQuantity::ALL.into_iter().filter_map(of).collect()
}

/// Returns the note on the unknowns of the model that are open; without any value there is no estimate.
fn undetermined(structure: &Microstructure, domain: &Domain) -> Option<Note> {
    let is_open =
        |q: &InferredQuantity| structure.get(*q).is_none() && domain.structure[*q as usize].is_some();
    let open: Vec<_> =
        InferredQuantity::ALL.into_iter().filter(is_open).map(InferredQuantity::name).collect();
    let is_nothing = structure.values().iter().all(Option::is_none);
    let severity = if is_nothing { Status::Unknown } else { Status::Ok };
    (!open.is_empty()).then(|| Note::undetermined(open.join(", ")).raised(severity))
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
