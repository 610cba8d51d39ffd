//! What makes an inversion impossible.

/// Why a model has no estimate for an observation.
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
        "the covariance of (G12, G13, Theta) is not one: {fault} ({value:e} Pa2); leave it out if it is not known"
    )]
    Covariance {
        /// What is wrong with it.
        fault: &'static str,
        /// The offending value, Pa².
        value: f64,
    },
    /// The strain ratio makes contacts of negative stiffness.
    #[error(
        "gamma/Delta = {g} is outside (-1, 1/2), where Eq. 10 gives some contacts a negative stiffness: \
         give the elastic or the contact-fitted ratio, or 0"
    )]
    GammaOutOfRange {
        /// g = γ/Δ.
        g: f64,
    },
    /// The shear ratio is one that no distribution of contacts has.
    #[error(
        "G13/G12 = {ratio} is outside (0, 2), where the theory lives: check that G13 is the shear along the axis"
    )]
    RatioOutOfRange {
        /// r = G13/G12.
        ratio: f64,
    },
    /// No contact anisotropy gives this shear ratio at this strain ratio.
    #[error(
        "no contact anisotropy gives G13/G12 = {ratio} at gamma/Delta = {g}: the strain ratio is too far from that of \
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
}
