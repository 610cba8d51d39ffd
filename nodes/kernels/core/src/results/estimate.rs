//! The result of one model of the microstructure.

use super::microstructure::{INFERENCE_INPUTS, InferredQuantity, MicrostructureCovariance};
use crate::notes::{Code, Note, Status};
use std::ops::Index;

const N: usize = InferredQuantity::COUNT;

/// The result of one model, as nodes send it and programs print it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Name of the model.
    pub model: String,
    /// Name of the calibration.
    pub calibration: String,
    /// Inferred values; `None`: undetermined, or not part of the model.
    pub values: Quantities<Option<f64>>,
    /// Covariance of the values, from data, model and prior; `None` if it is unknown.
    pub covariance: Option<MicrostructureCovariance>,
    /// Part of the covariance that is due to the model.
    pub covariance_model: Option<MicrostructureCovariance>,
    /// Credible intervals of the values.
    pub interval: Interval,
    /// Misfit: sum of squares weighted by the errors of data and model; `None` without degrees of freedom.
    pub chi_square: Option<f64>,
    /// Number of data minus number of unknowns; `None` without a solution.
    pub degrees_of_freedom: Option<usize>,
    /// Condition number, 1 or more: how much the effects of errors of the data differ between combinations.
    pub condition_number: Option<f64>,
    /// Share of each input in the variance that the errors of the data cause, in the order of [`INFERENCE_INPUTS`].
    pub information: Quantities<Option<[f64; INFERENCE_INPUTS.len()]>>,
    /// The strain ratio γ/Δ that the model used; `None` if it uses none.
    pub gamma: Option<GammaUsed>,
    /// Reliability of the estimate: the worst status of the notes.
    pub status: Status,
    /// Limitations and reasons; those that decide the status come first.
    pub notes: Vec<Note>,
}

/// The strain ratio γ/Δ that a model used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GammaUsed {
    /// Value of γ/Δ.
    pub value: f64,
    /// Source: `total`, `elastic`, `contact`: one of the measured ratios; `given`; `zero`: unknown, taken as 0.
    pub source: &'static str,
}

/// One value per quantity of the microstructure, in the order of [`InferredQuantity::ALL`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantities<T>(pub [T; N]);

/// Central intervals, low and high.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Interval {
    /// Probability inside each.
    pub level: Option<f64>,
    /// Low and high of each quantity.
    pub bounds: Quantities<Option<[f64; 2]>>,
}

impl Estimate {
    /// Creates the result of a model without an estimate, for these reasons.
    pub fn unknown(model: &str, calibration: &str, reasons: Vec<Note>) -> Self {
        Self {
            model: model.to_owned(),
            calibration: calibration.to_owned(),
            status: Status::Unknown,
            notes: reasons,
            ..Self::default()
        }
    }

    /// Returns the standard deviation of a quantity; `None` if the quantity or its uncertainty is unknown.
    pub fn sigma(&self, quantity: InferredQuantity) -> Option<f64> {
        self.values[quantity].and(stddev(&self.covariance, quantity))
    }

    /// Returns the part of the standard deviation that is due to the model.
    pub fn sigma_model(&self, quantity: InferredQuantity) -> Option<f64> {
        self.values[quantity].and(stddev(&self.covariance_model, quantity))
    }

    /// Adds notes on the data before the notes of the model, and takes the worst status. The worst notes come first.
    pub fn add_notes(&mut self, of_data: &[Note]) {
        self.notes.splice(0..0, of_data.iter().cloned());
        self.decide();
    }

    /// Gives the notes with this code a worse status, if `severity` is worse.
    pub fn raise(&mut self, code: Code, severity: Status) {
        for note in self.notes.iter_mut().filter(|note| note.is(code)) {
            *note = note.clone().raised(severity);
        }
        self.decide();
    }

    fn decide(&mut self) {
        self.notes.sort_by_key(|note| std::cmp::Reverse(note.severity()));
        self.status = self.status.max(Status::of(&self.notes));
    }
}

fn stddev(covariance: &Option<MicrostructureCovariance>, quantity: InferredQuantity) -> Option<f64> {
    covariance.map(|c| c[(quantity as usize, quantity as usize)].max(0.0).sqrt())
}

impl<T: Default> Default for Quantities<T> {
    fn default() -> Self {
        Self::from_fn(|_| T::default())
    }
}

impl<T> Quantities<T> {
    /// Creates each value by a function.
    pub fn from_fn(value: impl FnMut(InferredQuantity) -> T) -> Self {
        Self(InferredQuantity::ALL.map(value))
    }
}

impl<T> Index<InferredQuantity> for Quantities<T> {
    type Output = T;

    fn index(&self, quantity: InferredQuantity) -> &T {
        &self.0[quantity as usize]
    }
}
