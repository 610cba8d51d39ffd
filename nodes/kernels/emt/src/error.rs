//! Why an inversion or a prediction is impossible.

use crate::digits::{moved_out, too_far};
use crate::moduli::Modulus;

/// Why a model cannot invert an observation or predict moduli for a structure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EmtError {
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
    /// Moduli from which a structure follows that no packing has.
    #[error(
        "unknown: from these moduli follows {quantity} = {value:.3}, outside {low} to {high}, the range of every packing of \
         spheres: check the units of moduli and pressure (Pa), and the material"
    )]
    NoPacking {
        /// Name of the quantity.
        quantity: &'static str,
        /// The value found.
        value: f64,
        /// Lowest value of a packing.
        low: f64,
        /// Highest value of a packing.
        high: f64,
    },
    /// Contacts that are not Hertz–Mindlin contacts.
    #[error(
        "unknown: the contact law is {law}; this model is for Hertz-Mindlin contacts, whose stiffness follows from the material \
         of the grains: free-contact is for others"
    )]
    OtherContactLaw {
        /// Name of the law.
        law: &'static str,
    },
    /// Moduli of contacts without tangential springs.
    #[error(
        "unknown: the moduli are those of smooth grains, whose contacts have no tangential springs; every model is for \
         contacts that have them"
    )]
    SmoothGrains,
    /// A modulus that follows from the others is not that of a stable medium.
    #[error(
        "from the other moduli follows {modulus} = {value:e} Pa: they are not of one medium, or not of one state"
    )]
    Unstable {
        /// The modulus that follows from the others.
        modulus: &'static str,
        /// Value of the modulus, Pa.
        value: f64,
    },
    /// An input that the model needs is not known.
    #[error("needs {missing}, which is not given")]
    Missing {
        /// Name of the model.
        model: &'static str,
        /// Name of the missing input.
        missing: &'static str,
    },
    /// A structure or a state outside the model's domain.
    #[error("{quantity} = {value} is outside [{low}, {high}], the domain of model {model}")]
    OutsideDomain {
        /// Name of the model.
        model: &'static str,
        /// Name of the quantity.
        quantity: &'static str,
        /// The value found.
        value: f64,
        /// Lowest value of the domain.
        low: f64,
        /// Highest value of the domain.
        high: f64,
    },
    /// The calibration lacks the constants of the model.
    #[error("calibration `{calibration}` has no constants for model {model}: use another calibration")]
    NotCalibrated {
        /// Name of the model.
        model: &'static str,
        /// Name of the calibration.
        calibration: String,
    },
    /// The strain ratio makes the stiffness of contacts negative.
    #[error(
        "gamma/Delta = {g} is outside (-1, 1/2), where Eq. 10 gives every contact a positive stiffness; give the elastic or \
         the contact-fitted ratio, or 0"
    )]
    GammaOutOfRange {
        /// g = γ/Δ.
        g: f64,
    },
    /// No contact distribution has this shear ratio.
    #[error(
        "G13/G12 = {ratio:.4} is outside (0, 2), the range of the theory: check that G13 is the shear modulus along the axis"
    )]
    RatioOutOfRange {
        /// r = G13/G12.
        ratio: f64,
    },
    /// No contact anisotropy gives this shear ratio at this strain ratio.
    #[error(
        "no contact anisotropy gives G13/G12 = {ratio:.4} at gamma/Delta = {g}: the strain ratio differs too much from that \
         of the contacts; give the elastic or the contact-fitted ratio, or 0"
    )]
    NoAnisotropy {
        /// r = G13/G12.
        ratio: f64,
        /// g = γ/Δ.
        g: f64,
    },
    /// The shear modulus is too large relative to the bulk modulus.
    #[error(
        "G12/Theta = {ratio:.4} is not below {limit:.4}, the limit of calibration `{calibration}` at infinite coordination: \
         check the units and that both moduli are of one state, or use another calibration"
    )]
    ShearTooStiff {
        /// Ratio G12/Θ observed.
        ratio: f64,
        /// The value it must stay below at the observed G13/G12.
        limit: f64,
        /// Name of the calibration.
        calibration: String,
    },
    /// No coordination number of the calibration gives such moduli.
    #[error(
        "no coordination number of calibration `{calibration}` (from {low:.3} to {high:.3}) gives such moduli; those of {nearest:.3} \
         differ least: check units, pressure and material"
    )]
    NoCoordination {
        /// The coordination number with the best fit.
        nearest: f64,
        /// Lowest of the domain.
        low: f64,
        /// Highest of the domain.
        high: f64,
        /// Name of the calibration.
        calibration: String,
    },
    /// The packing differs too much from those of the calibration.
    #[error("unknown: {}", too_far(.quantity, *.value, [*.low, *.high], .calibration))]
    TooFar {
        /// Name of the quantity.
        quantity: &'static str,
        /// Value of the quantity.
        value: f64,
        /// Lowest of the packings.
        low: f64,
        /// Highest of the packings.
        high: f64,
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
        moved_out(.quantity, *.value, [*.low, *.high])
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
    /// Two microstructures explain the observation almost equally well.
    #[error(
        "coordination numbers {first:.3} and {second:.3} explain the moduli almost equally well: give more, or more accurate, \
         moduli"
    )]
    Ambiguous {
        /// Coordination number of one of them.
        first: f64,
        /// Coordination number of the other.
        second: f64,
    },
}

impl EmtError {
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

    /// `model` needs `modulus`, which is not known.
    pub(crate) fn missing(model: &'static str, modulus: Modulus) -> Self {
        EmtError::Missing { model, missing: modulus.name() }
    }
}
