//! Warnings about an estimate.

use crate::digits::{apart, of_quantity};
use crate::moduli::Modulus;
use crate::observation::UNKNOWN_ERROR;
use grainlab_core::results::InferredQuantity;
use std::fmt;

/// A limitation of an estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Warning {
    /// A coordination number lies outside the packings of the calibration.
    CoordinationOutsideFit {
        /// The quantity.
        quantity: InferredQuantity,
        /// Its value.
        value: f64,
        /// Lowest and highest of the calibration.
        range: [f64; 2],
    },
    /// The pressure lies outside the packings of the calibration.
    PressureOutsideFit {
        /// Pa.
        pressure: f64,
        /// Lowest and highest of the calibration, Pa.
        range: [f64; 2],
    },
    /// A coordination number is larger than equal spheres can have.
    CoordinationImpossible {
        /// The largest.
        coordination: f64,
    },
    /// G13/G12 is outside [2/3, 3/2], the range of packings whose only anisotropy is that of the contacts.
    RatioUnusual {
        /// r = G13/G12.
        ratio: f64,
    },
    /// ε is outside [−1/2, 1]: Eq. 6 then gives some directions a negative contact density.
    EpsOutOfRange {
        /// ε inferred.
        eps: f64,
    },
    /// ε is outside the packings of the calibration.
    EpsOutsideFit {
        /// ε inferred.
        eps: f64,
        /// Lowest and highest of the calibration.
        range: [f64; 2],
    },
    /// γ/Δ is outside [−0.3, 0.1], where the linear overlap law of Eq. 10 costs more than 0.005 in ε.
    GammaLarge {
        /// g = γ/Δ.
        g: f64,
    },
    /// γ/Δ is outside [−1/2, 1/4]: contacts in some directions would be open.
    ContactsOpen {
        /// g = γ/Δ.
        g: f64,
    },
    /// γ/Δ is not known and was taken as zero.
    GammaAssumedZero,
    /// The stress ratio q/p is not known; [`crate::UNKNOWN_STRESS_RATIO`] was taken.
    StressRatioUnknown,
    /// The sizes of the grains are not known; [`crate::UNKNOWN_SIZE_SPREAD`] was taken.
    SizesUnknown,
    /// An input of the state contributes most of the variance of a quantity.
    WidenedMost {
        /// Its name, one of [`crate::INPUT_NAMES`].
        input: &'static str,
        /// The quantity that it widens most.
        quantity: InferredQuantity,
        /// Its share of the variance of that quantity.
        share: f64,
    },
    /// The contact law is not known; Hertz–Mindlin contacts were assumed.
    ContactLawAssumed,
    /// A quantity of the state is outside the packings of the calibration.
    StateOutsideFit {
        /// Its name.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// Lowest and highest of the calibration.
        range: [f64; 2],
    },
    /// The model has contacts in all directions alike.
    IsotropicContacts,
    /// Share f of the contacts that stick in a shear wave, which makes the model fit Θ and the shear modulus.
    StickingShare {
        /// f, dimensionless.
        share: f64,
    },
    /// The Poisson ratio of the grains is not that of the calibration's packings.
    OtherGrains {
        /// ν of the grains.
        nu: f64,
        /// ν of the calibration.
        calibrated: f64,
    },
    /// The contacts resist rolling, and those of the calibration's packings do not.
    RollingResistance,
    /// The stiffness is not isotropic about the axis.
    NotTransverselyIsotropic {
        /// Relative part that is not isotropic.
        asymmetry: f64,
    },
    /// No stable medium has these moduli.
    NotOneMedium,
    /// Θ differs from the value that follows from C11, C33, C13 and G12 by more than the errors.
    Imbalance {
        /// Difference relative to Θ.
        relative: f64,
    },
    /// The coordination number is less than one contact per grain.
    CoordinationAbsurd {
        /// The quantity.
        quantity: InferredQuantity,
        /// Its value.
        value: f64,
    },
    /// The error of a modulus is too large for linear error propagation.
    ErrorsLarge {
        /// The modulus with the largest error.
        modulus: Modulus,
        /// Its relative standard deviation.
        relative: f64,
    },
    /// The error of a modulus is so large that the modulus was taken as unknown.
    TakenAsUnknown {
        /// The modulus.
        modulus: Modulus,
    },
    /// The errors of the moduli are not known, and the uncertainty is without them.
    DataErrorUnknown,
    /// The error of an input of the state is too large for linear error propagation.
    StateErrorLarge {
        /// Its name, one of [`crate::INPUT_NAMES`].
        input: &'static str,
        /// Its relative standard deviation.
        relative: f64,
    },
    /// The data contradict the prior.
    PriorConflict {
        /// The quantity.
        quantity: InferredQuantity,
        /// Its value by the data alone.
        value: f64,
        /// Mean of the prior.
        prior: f64,
        /// Their difference in standard deviations.
        sigma: f64,
    },
    /// The data contradict a limit of the prior.
    PriorExcludes {
        /// The quantity.
        quantity: InferredQuantity,
        /// Its value by the data alone.
        value: f64,
        /// The nearest limit of the prior.
        limit: f64,
        /// Their difference in standard deviations of the value.
        sigma: f64,
    },
    /// The data contradict the priors of several quantities together.
    PriorsConflict {
        /// Sum of squares weighted by the covariance of data and priors.
        chi_square: f64,
        /// Number of quantities with a prior.
        quantities: usize,
    },
    /// The data do not determine a quantity, so that its prior has no effect.
    PriorUnused {
        /// The quantity.
        quantity: InferredQuantity,
    },
    /// The data do not determine these unknowns of the model, in the order of [`InferredQuantity::ALL`].
    Undetermined {
        /// Whether each is open.
        quantities: [bool; InferredQuantity::COUNT],
    },
    /// The estimate is outside the domain of the model.
    OutsideDomain {
        /// The quantity.
        quantity: InferredQuantity,
        /// Its value.
        value: f64,
        /// Lowest and highest of the domain.
        range: [f64; 2],
    },
    /// The data contradict each other, or the model.
    Conflict {
        /// Sum of squares weighted by the errors of data and model.
        chi_square: f64,
        /// Number of data minus number of unknowns.
        degrees_of_freedom: usize,
        /// The modulus furthest from its prediction by the others, and the difference in standard deviations.
        worst: (Modulus, f64),
    },
    /// The moduli are improbable under the posterior, although their χ² about the estimate is ordinary.
    Improbable {
        /// Probability of the whole, or of the least probable modulus times their number.
        probability: f64,
    },
}

impl Warning {
    /// Whether the data contradict each other, the model or the prior.
    pub fn is_contradiction(&self) -> bool {
        matches!(
            self,
            Warning::NotOneMedium
                | Warning::Imbalance { .. }
                | Warning::Conflict { .. }
                | Warning::Improbable { .. }
                | Warning::PriorConflict { .. }
                | Warning::PriorExcludes { .. }
                | Warning::PriorsConflict { .. }
        )
    }

    /// Whether it follows from the structure and its uncertainty alone, which a prior changes.
    pub(crate) fn is_of_structure(&self) -> bool {
        matches!(
            self,
            Warning::CoordinationOutsideFit { .. }
                | Warning::CoordinationImpossible { .. }
                | Warning::CoordinationAbsurd { .. }
                | Warning::EpsOutOfRange { .. }
                | Warning::EpsOutsideFit { .. }
                | Warning::OutsideDomain { .. }
                | Warning::WidenedMost { .. }
        )
    }

    /// Whether the model or the calibration is used outside its range.
    pub fn is_extrapolation(&self) -> bool {
        !matches!(
            self,
            Warning::GammaAssumedZero
                | Warning::StressRatioUnknown
                | Warning::SizesUnknown
                | Warning::WidenedMost { .. }
                | Warning::ContactLawAssumed
                | Warning::IsotropicContacts
                | Warning::ErrorsLarge { .. }
                | Warning::TakenAsUnknown { .. }
                | Warning::DataErrorUnknown
                | Warning::StateErrorLarge { .. }
                | Warning::PriorConflict { .. }
                | Warning::PriorExcludes { .. }
                | Warning::PriorsConflict { .. }
                | Warning::PriorUnused { .. }
        ) && !matches!(self, Warning::StickingShare { share } if is_share(*share))
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::CoordinationOutsideFit { quantity, value, range } => {
                let [shown, low, high] = apart(*value, *range, 3);
                if *value < range[0] {
                    return write!(
                        f,
                        "{quantity} = {shown} is below {low}, the lowest of the calibration's packings"
                    );
                }
                write!(f, "{quantity} = {shown} is above {high}, the highest of the calibration's packings")
            }
            Warning::PressureOutsideFit { pressure, range } => {
                let [shown, low, high] = apart(pressure / 1e3, range.map(|p| p / 1e3), 4);
                write!(
                    f,
                    "a pressure of {shown} kPa is outside {low} to {high} kPa, the range of the calibration's packings"
                )
            }
            Warning::CoordinationImpossible { coordination } => {
                write!(
                    f,
                    "a coordination number of {coordination:.3} is larger than equal spheres can have (12): check the units (Pa)"
                )
            }
            Warning::RatioUnusual { ratio } => {
                write!(f, "G13/G12 = {ratio:.4} is outside [2/3, 3/2], the range of contact anisotropy alone")
            }
            Warning::EpsOutOfRange { eps } => {
                write!(
                    f,
                    "eps = {eps:.4} is outside [-1/2, 1]: the contact density would be negative in some directions"
                )
            }
            Warning::EpsOutsideFit { eps, range } => {
                let [shown, low, high] = apart(*eps, *range, 4);
                write!(f, "eps = {shown} is outside [{low}, {high}], the range of the calibration's packings")
            }
            Warning::GammaLarge { g } => {
                write!(
                    f,
                    "gamma/Delta = {g:.4} is outside [-0.3, 0.1], where Eq. 10 is accurate to 0.005 in eps"
                )
            }
            Warning::ContactsOpen { g } => {
                write!(
                    f,
                    "gamma/Delta = {g:.4} is outside [-1/2, 1/4]: contacts in some directions would be open"
                )
            }
            Warning::GammaAssumedZero => write!(f, "gamma/Delta is not known and was taken as 0"),
            Warning::RollingResistance => {
                write!(f, "the contacts resist rolling; no model knows packings whose contacts do")
            }
            Warning::StressRatioUnknown => write!(
                f,
                "the stress ratio q/p is not known: it is 0 +- 0.15, cut at +- 0.3, in value and error; a sample at rest in its bed \
                 (K0, q/p about 0.75) is outside"
            ),
            Warning::SizesUnknown => write!(
                f,
                "the spread of the grain sizes is not known: any from 0 to 0.3 is equally probable, in value and error"
            ),
            Warning::WidenedMost { input, quantity, share } => write!(
                f,
                "{input} widens most: {:.0} % of the variance of {quantity} is due to it",
                100.0 * share
            ),
            Warning::ContactLawAssumed => {
                write!(f, "the contact law is not known: the contacts were taken as Hertz-Mindlin contacts")
            }
            Warning::IsotropicContacts => {
                write!(f, "the model has contacts in all directions alike: eps is unknown, not zero")
            }
            Warning::StickingShare { share } => {
                let outside = if is_share(*share) { "" } else { " (outside [0, 1])" };
                write!(
                    f,
                    "the shear modulus over Theta is that of contacts of which a share f = {share:.3}{outside} sticks"
                )
            }
            Warning::StateOutsideFit { quantity, value, range } => {
                let [shown, low, high] = of_quantity(quantity, *value, *range);
                write!(
                    f,
                    "{quantity} = {shown} is outside {low} to {high}, the range of the calibration's packings"
                )
            }
            Warning::OtherGrains { nu, calibrated } => write!(
                f,
                "the Poisson ratio of the grains is {nu}, that of the calibration {calibrated}: moduli are scaled by the \
                 Hertz modulus alone"
            ),
            Warning::Undetermined { quantities } => {
                let open = InferredQuantity::ALL.into_iter().filter(|q| quantities[*q as usize]);
                let names: Vec<&str> = open.map(InferredQuantity::name).collect();
                write!(f, "the data do not determine {}", names.join(", "))
            }
            Warning::OutsideDomain { quantity, value, range } => {
                let [shown, low, high] = apart(*value, *range, 4);
                write!(f, "{quantity} = {shown} is outside [{low}, {high}], the domain of the model")
            }
            Warning::NotTransverselyIsotropic { asymmetry } => write!(
                f,
                "{:.1} % of the stiffness is not isotropic about the axis: the sample is not, or the axis is wrong",
                100.0 * asymmetry
            ),
            Warning::NotOneMedium => {
                write!(
                    f,
                    "no stable medium has these moduli: they are not of one state, or the errors are large"
                )
            }
            Warning::Imbalance { relative } => write!(
                f,
                "Theta is {:.1} % off the value that follows from C11, C33, C13 and G12: they are not of one state, or one of \
                 them is wrong",
                100.0 * relative.abs()
            ),
            Warning::CoordinationAbsurd { quantity, value } => write!(
                f,
                "{quantity} = {value:.3} is less than one contact per grain: check the units of moduli and pressure (Pa)"
            ),
            Warning::ErrorsLarge { modulus, relative } => write!(
                f,
                "{modulus} is known to {:.0} % only: intervals from linear error propagation are too narrow, use sampling",
                100.0 * relative
            ),
            Warning::TakenAsUnknown { modulus } => write!(
                f,
                "the error of {modulus} is more than {UNKNOWN_ERROR} times the largest modulus: {modulus} was taken as unknown"
            ),
            Warning::DataErrorUnknown => {
                write!(f, "the errors of the moduli are not known: the uncertainty does not include them")
            }
            Warning::StateErrorLarge { input, relative } => write!(
                f,
                "the {input} is known to {:.0} % only: intervals from linear error propagation are too narrow",
                100.0 * relative
            ),
            Warning::PriorConflict { quantity, value, prior, sigma } => write!(
                f,
                "the data alone give {quantity} = {value:.4}, {sigma:.1} sigma from {prior:.4}, the mean of its prior"
            ),
            Warning::PriorExcludes { quantity, value, limit, sigma } => write!(
                f,
                "the data alone give {quantity} = {value:.4}, {sigma:.1} sigma beyond {limit:.4}, the limit of its prior"
            ),
            Warning::PriorsConflict { chi_square, quantities } => write!(
                f,
                "the priors together contradict the data: chi-square {chi_square:.1} for {quantities} quantities with a prior"
            ),
            Warning::PriorUnused { quantity } => write!(
                f,
                "the data do not determine {quantity}, and its prior is not used; draws from the posterior use it"
            ),
            Warning::Conflict { chi_square, degrees_of_freedom: 1, .. } => write!(
                f,
                "the moduli contradict each other or the model: chi-square {chi_square:.1} for 1 degree of freedom, so that any of \
                 them may be wrong"
            ),
            Warning::Conflict { chi_square, degrees_of_freedom, worst: (modulus, sigma) } => write!(
                f,
                "the moduli contradict each other or the model: chi-square {chi_square:.1} for {degrees_of_freedom} \
                 degrees of freedom, {modulus} is {sigma:.1} sigma from its prediction by the others"
            ),
            Warning::Improbable { probability } => write!(
                f,
                "the moduli are improbable under the posterior (p = {probability:.0e}): the sample is unlike the packings of the \
                 calibration, or the errors are larger than given"
            ),
        }
    }
}

/// Whether a number is in [0, 1], to the rounding of its computation.
fn is_share(number: f64) -> bool {
    (-1e-9..=1.0 + 1e-9).contains(&number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_just_outside_a_range_is_printed_outside_of_it() {
        let text = |value| {
            Warning::StateOutsideFit { quantity: "q/p", value, range: [0.61834, 0.64663] }.to_string()
        };
        assert!(text(0.65).starts_with("q/p = 0.6500 is outside 0.6183 to 0.6466,"));
        assert!(text(0.64667).starts_with("q/p = 0.6467 is outside 0.6183 to 0.6466,"));
        assert!(text(0.646634).starts_with("q/p = 0.646634 is outside 0.618340 to 0.646630,"));
        assert!(text(0.618339).starts_with("q/p = 0.618339 is outside 0.618340 to 0.646630,"));
        let text = Warning::CoordinationOutsideFit {
            quantity: InferredQuantity::Z,
            value: 4.000_01,
            range: [3.0, 4.0],
        };
        assert!(text.to_string().starts_with("z = 4.00001 is above 4.00000,"), "{text}");
    }
}
