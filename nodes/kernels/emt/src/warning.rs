//! Warnings about an estimate.

use crate::digits::{apart, of_quantity};
use crate::moduli::Modulus;
use crate::observation::UNKNOWN_ERROR;
use crate::probe::UNKNOWN_PROBE;
use grainlab_core::results::InferredQuantity;

/// A limitation of an estimate.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Warning {
    /// A coordination number or ε lies outside the packings of the calibration.
    #[error("{}", beyond(*quantity, *value, *range))]
    OutsideFit {
        /// Name of the quantity.
        quantity: InferredQuantity,
        /// Value of the quantity.
        value: f64,
        /// Lowest and highest of the calibration.
        range: [f64; 2],
    },
    /// The pressure lies outside the packings of the calibration.
    #[error(
        "a pressure of {}, the range of the calibration's packings",
        outside(pressure / 1e3, range.map(|p| p / 1e3), 4, [" kPa is outside ", " to ", " kPa"])
    )]
    PressureOutsideFit {
        /// Pressure, in Pa.
        pressure: f64,
        /// Lowest and highest of the calibration, Pa.
        range: [f64; 2],
    },
    /// A coordination number is larger than equal spheres can have.
    #[error(
        "a coordination number of {coordination:.3} is larger than equal spheres can have (12): check the units (Pa)"
    )]
    CoordinationImpossible {
        /// Largest coordination number.
        coordination: f64,
    },
    /// G13/G12 is outside [2/3, 3/2], the range of packings whose only anisotropy is that of the contacts.
    #[error("G13/G12 = {ratio:.4} is outside [2/3, 3/2], the range of contact anisotropy alone")]
    RatioUnusual {
        /// r = G13/G12.
        ratio: f64,
    },
    /// ε is outside [−1/2, 1]: Eq. 6 then gives some directions a negative contact density.
    #[error("eps = {eps:.4} is outside [-1/2, 1]: the contact density would be negative in some directions")]
    EpsOutOfRange {
        /// Value of ε inferred.
        eps: f64,
    },
    /// γ/Δ is outside [−0.3, 0.1], where the linear overlap law of Eq. 10 costs more than 0.005 in ε.
    #[error("gamma/Delta = {g:.4} is outside [-0.3, 0.1], where Eq. 10 is accurate to 0.005 in eps")]
    GammaLarge {
        /// g = γ/Δ.
        g: f64,
    },
    /// γ/Δ is outside [−1/2, 1/4]: contacts in some directions would be open.
    #[error("gamma/Delta = {g:.4} is outside [-1/2, 1/4]: contacts in some directions would be open")]
    ContactsOpen {
        /// g = γ/Δ.
        g: f64,
    },
    /// γ/Δ is not known and was taken as zero.
    #[error("gamma/Delta is not known and was taken as 0")]
    GammaAssumedZero,
    /// The axial stress ratio is not known; [`crate::UNKNOWN_STRESS_RATIO`] was taken.
    #[error(
        "the axial stress ratio is not known: it is 0 +- 0.15, cut at +- 0.3, in value and error; a sample at rest in its bed \
         (K0, about 0.75) is outside"
    )]
    StressRatioUnknown,
    /// The sizes of the grains are not known; [`crate::UNKNOWN_SIZE_SPREAD`] was taken.
    #[error(
        "the spread of the grain sizes is not known: any from 0 to 0.3 is equally probable, in value and error"
    )]
    SizesUnknown,
    /// The number of grains is not known; the scatter is the mean over a range of numbers.
    #[error(
        "the number of grains is not known: the error is that of 100 to 20,000 grains, each number as probable on a logarithmic scale"
    )]
    GrainsUnknown,
    /// Contacts may have slid while the moduli were measured; [`crate::Probe::Unknown`] adds its errors.
    #[error(
        "contacts may have slid while the moduli were measured: standard deviations of {} in z, {} in k and {} in eps \
         are added, and eps_stiffness widens with eps",
        UNKNOWN_PROBE.z, UNKNOWN_PROBE.k, UNKNOWN_PROBE.eps
    )]
    ProbeUnknown,
    /// An input of the state contributes most of the variance of a quantity.
    #[error("{input} widens most: {:.0} % of the variance of {quantity} is due to it", 100.0 * share)]
    WidenedMost {
        /// Name of the input, one of [`grainlab_core::results::INFERENCE_INPUTS`].
        input: &'static str,
        /// The quantity that it widens most.
        quantity: InferredQuantity,
        /// Share of the variance of that quantity that is due to it.
        share: f64,
    },
    /// The contact law is not known; Hertz–Mindlin contacts were assumed.
    #[error("the contact law is not known: the contacts were taken as Hertz-Mindlin contacts")]
    ContactLawAssumed,
    /// Contacts that are not known are inferred with the structure.
    #[error(
        "the contacts are not known, and are inferred: k_t/k_n {:.2} +- {:.2}, moduli {level:.2} times those of smooth contacts; z \
         follows from the ratio of the moduli, and from simulated preparations", ratio[0], ratio[1]
    )]
    ContactsInferred {
        /// k_t/k_n and its standard deviation.
        ratio: [f64; 2],
        /// Moduli over those of the contact law with the given material and density.
        level: f64,
    },
    /// Contacts have another law than those of the calibration.
    #[error(
        "{law} contacts: the model takes their k_t/k_n, and not {}, because it takes no size of the grains; z follows from the ratio \
         of the moduli, and from simulated preparations", if *law == "rough" { "their roughness" } else { "their stiffness" }
    )]
    ContactsStated {
        /// Name of the law.
        law: &'static str,
    },
    /// Moduli are far from those of any contacts of these grains.
    #[error(
        "the moduli are {ratio:.2} times those of the contacts of these grains: check pressure, material, density and units"
    )]
    FarLevel {
        /// Moduli over those of the contact law.
        ratio: f64,
    },
    /// The data say little of a quantity.
    #[error("the data hardly determine {quantity}: {:.0} % of the standard deviation of its prior is left", 100.0 * left)]
    HardlyDetermined {
        /// Quantity that the data say little of.
        quantity: InferredQuantity,
        /// Standard deviation over that of the prior.
        left: f64,
    },
    /// The posterior contains higher z than are stated.
    #[error("{:.0} % of the posterior has z above 6.6, where nothing is stated", 100.0 * share)]
    HigherZ {
        /// Probability of a higher z.
        share: f64,
    },
    /// The posterior contains lower z than the packings of the calibration have.
    #[error("{:.0} % of the posterior has z below {lowest:.2}, the lowest of the calibration's packings", 100.0 * share)]
    LowerZ {
        /// Probability of a lower z.
        share: f64,
        /// Lowest z of the calibration.
        lowest: f64,
    },
    /// A quantity of the state is outside the packings of the calibration.
    #[error("{quantity} = {}, the range of the calibration's packings", of_state(quantity, *value, *range))]
    StateOutsideFit {
        /// Name of the quantity.
        quantity: &'static str,
        /// Value of the quantity.
        value: f64,
        /// Lowest and highest of the calibration.
        range: [f64; 2],
    },
    /// The model has contacts in all directions alike.
    #[error("the model has contacts in all directions alike: eps is unknown, not zero")]
    IsotropicContacts,
    /// Share f of the contacts that stick in a shear wave, which makes the model fit Θ and the shear modulus.
    #[error(
        "the shear modulus over Theta is that of contacts of which a share f = {share:.3}{} sticks",
        if is_share(*share) { "" } else { " (outside [0, 1])" }
    )]
    StickingShare {
        /// Share f, dimensionless.
        share: f64,
    },
    /// The Poisson ratio of the grains is not that of the calibration's packings.
    #[error(
        "the Poisson ratio of the grains is {nu}, that of the calibration {calibrated}: moduli are scaled by the \
         Hertz modulus alone"
    )]
    OtherGrains {
        /// ν of the grains.
        nu: f64,
        /// ν of the calibration.
        calibrated: f64,
    },
    /// The contacts resist rolling, and those of the calibration's packings do not.
    #[error("the contacts resist rolling; no model knows packings whose contacts do")]
    RollingResistance,
    /// The stiffness is not isotropic about the axis.
    #[error(
        "{:.1} % of the stiffness is not isotropic about the axis: the sample is not, or the axis is wrong", 100.0 * asymmetry
    )]
    NotTransverselyIsotropic {
        /// Relative part that is not isotropic.
        asymmetry: f64,
    },
    /// No stable medium has these moduli.
    #[error("no stable medium has these moduli: they are not of one state, or the errors are large")]
    NotOneMedium,
    /// Θ differs from the value that follows from C11, C33, C13 and G12 by more than the errors.
    #[error(
        "Theta is {:.1} % off the value that follows from C11, C33, C13 and G12: they are not of one state, or one of \
         them is wrong", 100.0 * relative.abs()
    )]
    Imbalance {
        /// Difference relative to Θ.
        relative: f64,
    },
    /// The coordination number is less than one contact per grain.
    #[error(
        "{quantity} = {value:.3} is less than one contact per grain: check the units of moduli and pressure (Pa)"
    )]
    CoordinationAbsurd {
        /// Name of the quantity.
        quantity: InferredQuantity,
        /// Value of the quantity.
        value: f64,
    },
    /// The error of a modulus is too large for linear error propagation.
    #[error(
        "{modulus} is known to {:.0} % only: intervals from linear error propagation are too narrow",
        100.0 * relative
    )]
    ErrorsLarge {
        /// The modulus with the largest error.
        modulus: Modulus,
        /// Relative standard deviation of it.
        relative: f64,
    },
    /// The error of a modulus is so large that the modulus was taken as unknown.
    #[error(
        "the error of {modulus} is more than {UNKNOWN_ERROR} times the largest modulus: {modulus} was taken as unknown"
    )]
    TakenAsUnknown {
        /// Name of the modulus.
        modulus: Modulus,
    },
    /// The errors of the moduli are not known, and the uncertainty is without them.
    #[error("the errors of the moduli are not known: the uncertainty does not include them")]
    DataErrorUnknown,
    /// The error of an input of the state is too large for linear error propagation.
    #[error(
        "the {input} is known to {:.0} % only: intervals from linear error propagation are too narrow", 100.0 * relative
    )]
    StateErrorLarge {
        /// Name of the input, one of [`grainlab_core::results::INFERENCE_INPUTS`].
        input: &'static str,
        /// Relative standard deviation of it.
        relative: f64,
    },
    /// The data contradict the prior.
    #[error(
        "the data alone give {quantity} = {value:.4}, {sigma:.1} sigma from {prior:.4}, the mean of its prior"
    )]
    PriorConflict {
        /// Name of the quantity.
        quantity: InferredQuantity,
        /// Value by the data alone.
        value: f64,
        /// Mean of the prior.
        prior: f64,
        /// Difference of both in standard deviations.
        sigma: f64,
    },
    /// The data contradict a limit of the prior.
    #[error(
        "the data alone give {quantity} = {value:.4}, {sigma:.1} sigma beyond {limit:.4}, the limit of its prior"
    )]
    PriorExcludes {
        /// Name of the quantity.
        quantity: InferredQuantity,
        /// Value by the data alone.
        value: f64,
        /// The nearest limit of the prior.
        limit: f64,
        /// Difference of both in standard deviations of the value.
        sigma: f64,
    },
    /// The data contradict the priors of several quantities together.
    #[error(
        "the priors together contradict the data: chi-square {chi_square:.1} for {quantities} quantities with a prior"
    )]
    PriorsConflict {
        /// Sum of squares weighted by the covariance of data and priors.
        chi_square: f64,
        /// Number of quantities with a prior.
        quantities: usize,
    },
    /// The data do not determine a quantity, so that its prior has no effect.
    #[error(
        "the data do not determine {quantity}, and its prior is not used; draws from the posterior use it"
    )]
    PriorUnused {
        /// Name of the quantity.
        quantity: InferredQuantity,
    },
    /// The data do not determine these unknowns of the model, in the order of [`InferredQuantity::ALL`].
    #[error("the data do not determine {}", names(quantities))]
    Undetermined {
        /// For each quantity, true if it is open.
        quantities: [bool; InferredQuantity::COUNT],
    },
    /// The estimate is outside the domain of the model.
    #[error(
        "{quantity} = {}, the domain of the model", outside(*value, *range, 4, [" is outside [", ", ", "]"])
    )]
    OutsideDomain {
        /// Name of the quantity.
        quantity: InferredQuantity,
        /// Value of the quantity.
        value: f64,
        /// Lowest and highest of the domain.
        range: [f64; 2],
    },
    /// The data contradict each other, or the model.
    #[error(
        "the moduli contradict each other or the model: chi-square {chi_square:.1} for {}",
        degrees(*degrees_of_freedom, *worst)
    )]
    Conflict {
        /// Sum of squares weighted by the errors of data and model.
        chi_square: f64,
        /// Number of data minus number of unknowns.
        degrees_of_freedom: usize,
        /// The modulus furthest from its prediction by the others, and the difference in standard deviations.
        worst: (Modulus, f64),
    },
    /// The moduli fit no structure of the calibration's packings well.
    #[error(
        "the moduli fit the calibration's packings badly (p = {probability:.1e}): the sample is of another kind, or the errors are \
         larger than given; do not rely on the stated errors"
    )]
    Unlike {
        /// Probability of a larger χ², or of a modulus further from its prediction by the others.
        probability: f64,
    },
    /// The moduli are improbable under the posterior, although their χ² about the estimate is ordinary.
    #[error(
        "the moduli are improbable under the posterior (p = {probability:.0e}): the sample is unlike the packings of the \
         calibration, or the errors are larger than given"
    )]
    Improbable {
        /// Probability of the whole, or of the least probable modulus times their number.
        probability: f64,
    },
}

impl Warning {
    /// True if the data contradict each other, the model or the prior.
    pub fn is_contradiction(&self) -> bool {
        matches!(
            self,
            Warning::NotOneMedium
                | Warning::Imbalance { .. }
                | Warning::Conflict { .. }
                | Warning::Improbable { .. }
                | Warning::FarLevel { .. }
                | Warning::PriorConflict { .. }
                | Warning::PriorExcludes { .. }
                | Warning::PriorsConflict { .. }
        )
    }

    /// True if it follows from the structure and its uncertainty alone, which a prior changes.
    pub(crate) fn is_of_structure(&self) -> bool {
        matches!(
            self,
            Warning::OutsideFit { .. }
                | Warning::CoordinationImpossible { .. }
                | Warning::CoordinationAbsurd { .. }
                | Warning::EpsOutOfRange { .. }
                | Warning::OutsideDomain { .. }
                | Warning::WidenedMost { .. }
        )
    }

    /// True if the model or the calibration is used outside its range.
    pub fn is_extrapolation(&self) -> bool {
        !matches!(
            self,
            Warning::GammaAssumedZero
                | Warning::StressRatioUnknown
                | Warning::SizesUnknown
                | Warning::GrainsUnknown
                | Warning::ProbeUnknown
                | Warning::WidenedMost { .. }
                | Warning::ContactLawAssumed
                | Warning::ContactsInferred { .. }
                | Warning::ContactsStated { .. }
                | Warning::HardlyDetermined { .. }
                | Warning::HigherZ { .. }
                | Warning::LowerZ { .. }
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

/// A value and the ends of a range that it is outside of, with these texts between.
fn outside(value: f64, range: [f64; 2], digits: usize, [is, to, end]: [&str; 3]) -> String {
    let [value, low, high] = apart(value, range, digits);
    format!("{value}{is}{low}{to}{high}{end}")
}

fn of_state(quantity: &str, value: f64, range: [f64; 2]) -> String {
    let [value, low, high] = of_quantity(quantity, value, range);
    format!("{value} is outside {low} to {high}")
}

fn beyond(quantity: InferredQuantity, value: f64, range: [f64; 2]) -> String {
    if quantity == InferredQuantity::Eps {
        let text = outside(value, range, 4, [" is outside [", ", ", "]"]);
        return format!("{quantity} = {text}, the range of the calibration's packings");
    }
    let [shown, low, high] = apart(value, range, 3);
    if value < range[0] {
        return format!("{quantity} = {shown} is below {low}, the lowest of the calibration's packings");
    }
    format!("{quantity} = {shown} is above {high}, the highest of the calibration's packings")
}

fn names(open: &[bool; InferredQuantity::COUNT]) -> String {
    let open = InferredQuantity::ALL.into_iter().filter(|q| open[*q as usize]);
    open.map(InferredQuantity::name).collect::<Vec<_>>().join(", ")
}

fn degrees(degrees_of_freedom: usize, (modulus, sigma): (Modulus, f64)) -> String {
    match degrees_of_freedom {
        1 => "1 degree of freedom, so that any of them may be wrong".to_owned(),
        n => {
            format!("{n} degrees of freedom, {modulus} is {sigma:.1} sigma from its prediction by the others")
        }
    }
}

/// True if a number is in [0, 1], to the rounding of its computation.
fn is_share(number: f64) -> bool {
    (-1e-9..=1.0 + 1e-9).contains(&number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_just_outside_a_range_is_printed_outside_of_it() {
        let text = |value| {
            Warning::StateOutsideFit { quantity: "the axial stress ratio", value, range: [0.61834, 0.64663] }
                .to_string()
        };
        assert!(text(0.65).starts_with("the axial stress ratio = 0.6500 is outside 0.6183 to 0.6466,"));
        assert!(text(0.64667).starts_with("the axial stress ratio = 0.6467 is outside 0.6183 to 0.6466,"));
        assert!(
            text(0.646634).starts_with("the axial stress ratio = 0.646634 is outside 0.618340 to 0.646630,")
        );
        assert!(
            text(0.618339).starts_with("the axial stress ratio = 0.618339 is outside 0.618340 to 0.646630,")
        );
        let text = Warning::OutsideFit { quantity: InferredQuantity::Z, value: 4.000_01, range: [3.0, 4.0] };
        assert!(text.to_string().starts_with("z = 4.00001 is above 4.00000,"), "{text}");
    }
}
