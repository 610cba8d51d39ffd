//! Why an inversion or a prediction is impossible.

use crate::moduli::Modulus;
use grainlab_core::notes::{Code, Note};

/// Why a model cannot invert an observation or predict moduli for a structure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EmtError {
    /// The data have no answer by this model.
    #[error("{0}")]
    NoAnswer(Note),
    /// An input, or a number computed from it, is not finite.
    #[error("{quantity} = {value} is not finite: check the given numbers and their units")]
    NotFinite {
        /// Name of the quantity.
        quantity: &'static str,
        /// The value found.
        value: f64,
    },
    /// A modulus or the pressure is not positive.
    #[error(
        "{quantity} = {value:e} Pa must be positive: the packing is not jammed, or the unit or sign is wrong"
    )]
    NotPositive {
        /// Name of the input.
        quantity: &'static str,
        /// The value found, Pa.
        value: f64,
    },
    /// A standard deviation is negative.
    #[error("{quantity} = {value:e} must not be negative; 0 takes the quantity as exact")]
    NegativeStddev {
        /// Name of the input.
        quantity: &'static str,
        /// The value found.
        value: f64,
    },
    /// An invalid covariance.
    #[error(
        "the covariance of the moduli is invalid: {fault} ({value:e} Pa2); leave it out if it is not known"
    )]
    Covariance {
        /// Fault of the covariance.
        fault: &'static str,
        /// The offending value, Pa².
        value: f64,
    },
    /// A state or grains that no packing has.
    #[error("{quantity} = {value} is outside {range}")]
    NoState {
        /// Name of the quantity.
        quantity: &'static str,
        /// The value found.
        value: f64,
        /// The possible values.
        range: &'static str,
    },
    /// Too few or too many speeds of a sample.
    #[error(
        "{measured} measured speeds: a sample has {least} to {most}; of more, take means over pressures that are near each other"
    )]
    SeriesLength {
        /// Number of the speeds.
        measured: usize,
        /// Fewest speeds of a sample.
        least: usize,
        /// Most speeds of a sample.
        most: usize,
    },
    /// An invalid prior of a series.
    #[error("the prior of the series is invalid: {fault}")]
    SeriesPrior {
        /// Fault, with its line or the name of the key.
        fault: String,
    },
    /// A structure that no packing has.
    #[error("{quantity} = {value} is outside [{low}, {high}], which contains that of every packing")]
    NoStructure {
        /// Name of the quantity.
        quantity: &'static str,
        /// The value found.
        value: f64,
        /// Lowest possible value.
        low: f64,
        /// Highest possible value.
        high: f64,
    },
    /// An input that the model needs is not known.
    #[error("needs {missing}, which is not given")]
    Missing {
        /// Name of the model.
        model: &'static str,
        /// Name of the missing input.
        missing: &'static str,
    },
    /// The calibration lacks the constants of the model.
    #[error("calibration `{calibration}` has no constants for model {model}: use another calibration")]
    NotCalibrated {
        /// Name of the model.
        model: &'static str,
        /// Name of the calibration.
        calibration: String,
    },
    /// A prior leaves nothing of the domain of a model.
    #[error(
        "the prior of {quantity} leaves no probability within [{low}, {high}], the domain of model {model}: widen or move it"
    )]
    PriorOutsideDomain {
        /// Name of the model.
        model: &'static str,
        /// Name of the quantity.
        quantity: &'static str,
        /// Lowest of the domain.
        low: f64,
        /// Highest of the domain.
        high: f64,
    },
    /// With the priors, the structure is outside the domain of the model.
    #[error(
        "with its priors, {}: the priors contradict the moduli; widen or move them",
        Note::outside_domain(*.quantity, *.value, *.low, *.high)
    )]
    PriorContradicts {
        /// Name of the quantity.
        quantity: &'static str,
        /// The value found.
        value: f64,
        /// Lowest of the domain.
        low: f64,
        /// Highest of the domain.
        high: f64,
    },
    /// The model states no likelihood of the moduli.
    #[error("model {model} states no likelihood of these moduli: {reason}")]
    NoLikelihood {
        /// Name of the model.
        model: &'static str,
        /// Why, and what to do.
        reason: &'static str,
    },
    /// The posterior cannot be sampled.
    #[error("the posterior of model {model} cannot be sampled: {reason}")]
    NotSampled {
        /// Name of the model.
        model: &'static str,
        /// Why, and what to do.
        reason: &'static str,
    },
}

impl From<Note> for EmtError {
    fn from(reason: Note) -> Self {
        Self::NoAnswer(reason)
    }
}

impl From<&EmtError> for Note {
    fn from(error: &EmtError) -> Self {
        match error {
            EmtError::NoAnswer(reason) => reason.clone(),
            other => Note::no_answer(other.to_string()),
        }
    }
}

impl EmtError {
    /// Returns true if the data have no answer for the reason with this code.
    pub fn is(&self, code: Code) -> bool {
        matches!(self, EmtError::NoAnswer(reason) if reason.is(code))
    }

    /// True if the data are missing or invalid, rather than inconsistent with the theory.
    pub fn is_input_error(&self) -> bool {
        use EmtError::*;
        matches!(
            self,
            NotFinite { .. }
                | NotPositive { .. }
                | NegativeStddev { .. }
                | Covariance { .. }
                | NoState { .. }
                | NoStructure { .. }
                | Missing { .. }
                | NotCalibrated { .. }
                | PriorOutsideDomain { .. }
                | PriorContradicts { .. }
                | NoLikelihood { .. }
        )
    }

    pub(crate) fn missing(model: &'static str, modulus: Modulus) -> Self {
        EmtError::Missing { model, missing: modulus.name() }
    }
}
