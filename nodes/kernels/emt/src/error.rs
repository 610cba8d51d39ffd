//! What makes an inversion impossible.

use crate::moduli::Modulus;

/// Why a model has no estimate for an observation, or no prediction for a structure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EmtError {
    /// An input, or what follows from it, is not finite.
    #[error("{quantity} = {value} is not finite: check the numbers given and their units")]
    NotFinite {
        /// Which quantity.
        quantity: &'static str,
        /// The value found.
        value: f64,
    },
    /// A modulus or the pressure is not positive.
    #[error("{quantity} = {value:e} Pa must be positive: there is no network, or the unit or sign is wrong")]
    NotPositive {
        /// Which input.
        quantity: &'static str,
        /// The value found, Pa.
        value: f64,
    },
    /// A standard deviation is negative.
    #[error("{quantity} = {value:e} must not be negative; 0 takes the quantity as exact")]
    NegativeStddev {
        /// Which input.
        quantity: &'static str,
        /// The value found.
        value: f64,
    },
    /// Not a covariance.
    #[error(
        "the covariance of the moduli is not one: {fault} ({value:e} Pa2); leave it out if it is not known"
    )]
    Covariance {
        /// What is wrong with it.
        fault: &'static str,
        /// The offending value, Pa².
        value: f64,
    },
    /// Not a solid fraction.
    #[error("the solid fraction {phi} is outside (0, 1)")]
    SolidFraction {
        /// The value found.
        phi: f64,
    },
    /// Not a Poisson ratio of a grain.
    #[error("the Poisson ratio of the grains, {nu}, is outside [0, 1/2]")]
    PoissonRatio {
        /// The value found.
        nu: f64,
    },
    /// The moduli given leave a value to another that no stable medium has.
    #[error(
        "the moduli given leave {modulus} = {value:e} Pa: they are not of one medium, or not of one state"
    )]
    Unstable {
        /// The modulus that follows from the others.
        modulus: &'static str,
        /// Its value, Pa.
        value: f64,
    },
    /// Something that the model cannot do without is not known.
    #[error("model {model} needs {missing}, which is not given")]
    Missing {
        /// Name of the model.
        model: &'static str,
        /// What is missing.
        missing: &'static str,
    },
    /// A structure or a state outside the model's domain.
    #[error("{quantity} = {value} is outside [{low}, {high}], where model {model} lives")]
    OutsideDomain {
        /// Name of the model.
        model: &'static str,
        /// Which quantity.
        quantity: &'static str,
        /// The value found.
        value: f64,
        /// Lowest value of the domain.
        low: f64,
        /// Highest value of the domain.
        high: f64,
    },
    /// The calibration does not hold what the model needs.
    #[error("calibration `{calibration}` does not hold the constants of model {model}: take another")]
    NotCalibrated {
        /// Name of the model.
        model: &'static str,
        /// Name of the calibration.
        calibration: String,
    },
    /// The strain ratio leaves contacts open, or makes their stiffness negative.
    #[error(
        "gamma/Delta = {g} is outside {range}: beyond it {law} leaves some contacts without a positive stiffness; \
         give the elastic or the contact-fitted ratio, or 0"
    )]
    GammaOutOfRange {
        /// g = γ/Δ.
        g: f64,
        /// The range it must be in.
        range: &'static str,
        /// The overlap law that says so.
        law: &'static str,
    },
    /// The shear ratio is one that no distribution of contacts has.
    #[error(
        "G13/G12 = {ratio:.4} is outside (0, 2), where the theory lives: check that G13 is the shear along the axis"
    )]
    RatioOutOfRange {
        /// r = G13/G12.
        ratio: f64,
    },
    /// No contact anisotropy gives this shear ratio at this strain ratio.
    #[error(
        "no contact anisotropy gives G13/G12 = {ratio:.4} at gamma/Delta = {g}: the strain ratio is too far from that of \
         the contacts; give the elastic or the contact-fitted ratio, or 0"
    )]
    NoAnisotropy {
        /// r = G13/G12.
        ratio: f64,
        /// g = γ/Δ.
        g: f64,
    },
    /// The shear modulus is too large beside the bulk modulus.
    #[error(
        "G12/Theta = {ratio:.4} is not below {limit:.4}, which calibration `{calibration}` reaches only at infinite \
         coordination: check the units, that both moduli are of one state, or use another calibration"
    )]
    ShearTooStiff {
        /// G12/Θ.
        ratio: f64,
        /// The value it must stay below at the observed G13/G12.
        limit: f64,
        /// Name of the calibration.
        calibration: String,
    },
    /// No coordination of the calibration has such moduli.
    #[error(
        "no coordination number in [{low:.3}, {high:.3}], where calibration `{calibration}` lives, fits the moduli ({nearest:.3} \
         comes nearest): check units, pressure and material"
    )]
    NoCoordination {
        /// Coordination that comes nearest.
        nearest: f64,
        /// Lowest of the domain.
        low: f64,
        /// Highest of the domain.
        high: f64,
        /// Name of the calibration.
        calibration: String,
    },
    /// Two microstructures explain the observation almost equally well.
    #[error(
        "coordination numbers {first:.3} and {second:.3} explain the moduli almost equally well: give more moduli, or more \
         exact ones"
    )]
    Ambiguous {
        /// One of them.
        first: f64,
        /// The other.
        second: f64,
    },
}

impl EmtError {
    /// Whether the data are too few, or are no data, rather than at odds with the theory.
    pub fn is_of_input(&self) -> bool {
        match self {
            EmtError::NotFinite { .. }
            | EmtError::NotPositive { .. }
            | EmtError::NegativeStddev { .. }
            | EmtError::Covariance { .. }
            | EmtError::SolidFraction { .. }
            | EmtError::PoissonRatio { .. }
            | EmtError::Missing { .. }
            | EmtError::NotCalibrated { .. } => true,
            EmtError::Unstable { .. }
            | EmtError::OutsideDomain { .. }
            | EmtError::GammaOutOfRange { .. }
            | EmtError::RatioOutOfRange { .. }
            | EmtError::NoAnisotropy { .. }
            | EmtError::ShearTooStiff { .. }
            | EmtError::NoCoordination { .. }
            | EmtError::Ambiguous { .. } => false,
        }
    }

    /// Of `model`, which works with `modulus`.
    pub(crate) fn missing(model: &'static str, modulus: Modulus) -> Self {
        EmtError::Missing { model, missing: modulus.name() }
    }
}
