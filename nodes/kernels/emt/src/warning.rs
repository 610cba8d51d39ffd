//! What to keep in mind about an estimate.

use crate::calibration::Calibration;
use crate::conditions::GammaSource;
use crate::moduli::Modulus;
use crate::observation::Observation;
use crate::structure::{Quantity, Structure};
use std::fmt;

/// Coordination number of a close packing of equal spheres: more contacts than that find no room.
const CLOSE_PACKING: f64 = 12.0;

/// Asymmetry of a stiffness beyond which it is no medium isotropic about e3, whatever the number of grains.
const ASYMMETRY: f64 = 0.05;

/// Asymmetry times the root of the number of grains that packings which are isotropic about e3 stay below.
const SCATTER: f64 = 2.2;

/// Imbalance of moduli that were rounded to three or four digits.
const ROUNDING: f64 = 5e-3;

/// Standard deviations that chance does not reach once in a thousand.
const CERTAIN: f64 = 3.3;

/// Relative error of a modulus beyond which slopes no longer tell the error of an estimate: at 5 % the intervals still hold
/// what they promise, at 30 % they do not.
const LARGE_ERROR: f64 = 0.1;

/// What to keep in mind about an estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Warning {
    /// A coordination number lies outside the packings of the calibration.
    CoordinationOutsideFit {
        /// Which one.
        quantity: Quantity,
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
    /// A coordination number is more than equal spheres find room for.
    CoordinationImpossible {
        /// The largest.
        coordination: f64,
    },
    /// G13/G12 is outside [2/3, 3/2], the range that contact anisotropy alone can give.
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
    /// The solid fraction is not known; that of the calibration's packings was taken, with their scatter.
    SolidFractionAssumed {
        /// Their mean.
        phi: f64,
    },
    /// The solid fraction is outside the packings of the calibration: of k more than of z or ε it decides the rattlers.
    SolidFractionOutsideFit {
        /// φ.
        phi: f64,
        /// Lowest and highest of the calibration.
        range: [f64; 2],
    },
    /// The Poisson ratio of the grains is not that of the calibration's packings.
    OtherGrains {
        /// ν of the grains.
        nu: f64,
        /// ν of the calibration.
        calibrated: f64,
    },
    /// The stiffness is not isotropic about the axis.
    NotTransverselyIsotropic {
        /// Relative part that is not.
        asymmetry: f64,
    },
    /// No stable medium has these moduli.
    NotOneMedium,
    /// Θ is not what C11, C33, C13 and G12 make it, by more than the errors.
    Imbalance {
        /// Difference in parts of Θ.
        relative: f64,
    },
    /// A coordination number is less than one contact a grain.
    CoordinationAbsurd {
        /// Which one.
        quantity: Quantity,
        /// Its value.
        value: f64,
    },
    /// The error of a modulus is too large for intervals that are linear in it.
    ErrorsLarge {
        /// The modulus of the largest.
        modulus: Modulus,
        /// One sigma, in parts of the modulus.
        relative: f64,
    },
    /// The data contradict each other, or the model.
    Conflict {
        /// Misfit by the errors of data and model.
        chi_square: f64,
        /// Data less unknowns.
        degrees_of_freedom: usize,
        /// The modulus furthest from what the others say, and by how many sigma.
        worst: (Modulus, f64),
    },
}

impl Warning {
    /// Whether the model or the calibration is used outside its range.
    pub fn is_extrapolation(&self) -> bool {
        !matches!(
            self,
            Warning::GammaAssumedZero | Warning::SolidFractionAssumed { .. } | Warning::ErrorsLarge { .. }
        )
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::CoordinationOutsideFit { quantity, value, range: [low, high] } => {
                if value < low {
                    return write!(
                        f,
                        "{quantity} = {value:.3} is below {low:.3}, the lowest that the calibration was fitted to"
                    );
                }
                write!(
                    f,
                    "{quantity} = {value:.3} is above {high:.3}, the highest that the calibration was fitted to"
                )
            }
            Warning::PressureOutsideFit { pressure, range: [low, high] } => write!(
                f,
                "a pressure of {:.4} kPa is outside {:.4} to {:.4} kPa, which the calibration was fitted to",
                pressure / 1e3,
                low / 1e3,
                high / 1e3
            ),
            Warning::CoordinationImpossible { coordination } => {
                write!(
                    f,
                    "a coordination number of {coordination:.3} is more than equal spheres find room for (12): check the units (Pa)"
                )
            }
            Warning::RatioUnusual { ratio } => {
                write!(
                    f,
                    "G13/G12 = {ratio:.4} is outside [2/3, 3/2], what contact anisotropy alone can give"
                )
            }
            Warning::EpsOutOfRange { eps } => {
                write!(
                    f,
                    "eps = {eps:.4} is outside [-1/2, 1]: some directions would have fewer than no contacts"
                )
            }
            Warning::EpsOutsideFit { eps, range: [low, high] } => write!(
                f,
                "eps = {eps:.4} is outside [{low:.3}, {high:.3}], which the calibration was fitted to"
            ),
            Warning::GammaLarge { g } => {
                write!(f, "gamma/Delta = {g:.4} is outside [-0.3, 0.1], where Eq. 10 is good to 0.005 in eps")
            }
            Warning::ContactsOpen { g } => {
                write!(
                    f,
                    "gamma/Delta = {g:.4} is outside [-1/2, 1/4]: contacts in some directions would be open"
                )
            }
            Warning::GammaAssumedZero => write!(f, "gamma/Delta is not known and was taken as 0"),
            Warning::SolidFractionAssumed { phi } => {
                write!(
                    f,
                    "the solid fraction is not known: {phi:.3} was taken, with the scatter of the calibration's packings"
                )
            }
            Warning::SolidFractionOutsideFit { phi, range: [low, high] } => write!(
                f,
                "the solid fraction {phi:.4} is outside {low:.3} to {high:.3}, which the calibration was fitted to: k is not to \
                 be trusted"
            ),
            Warning::OtherGrains { nu, calibrated } => write!(
                f,
                "the grains have a Poisson ratio of {nu}, the calibration is for {calibrated}: its moduli are scaled by \
                 the Hertz modulus alone"
            ),
            Warning::NotTransverselyIsotropic { asymmetry } => write!(
                f,
                "{:.1} % of the stiffness is not isotropic about the axis: the sample is not, or the axis is another",
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
                "Theta is {:.1} % off what C11, C33, C13 and G12 make it: they are not of one state, or one of them is wrong",
                100.0 * relative.abs()
            ),
            Warning::CoordinationAbsurd { quantity, value } => write!(
                f,
                "{quantity} = {value:.3} is less than one contact a grain: check the units of moduli and pressure (Pa)"
            ),
            Warning::ErrorsLarge { modulus, relative } => write!(
                f,
                "{modulus} is known to {:.0} % only: intervals are linear in the errors and too narrow here, draw samples",
                100.0 * relative
            ),
            Warning::Conflict { chi_square, degrees_of_freedom, worst: (modulus, sigma) } => write!(
                f,
                "the moduli contradict each other or the model: chi-square {chi_square:.1} for {degrees_of_freedom} \
                 degrees of freedom, {modulus} is {sigma:.1} sigma from what the others say"
            ),
        }
    }
}

/// What can be said of every model's estimate from the observation and the structure alone.
pub(crate) fn common(
    observation: &Observation,
    structure: &Structure,
    calibration: &Calibration,
    uses_gamma: bool,
) -> Vec<Warning> {
    let conditions = &observation.conditions;
    let mut warnings = Vec::new();
    let mut add = |applies: bool, warning: Warning| {
        if applies {
            warnings.push(warning);
        }
    };
    let outside = |v: f64, [low, high]: [f64; 2]| !(low..=high).contains(&v);
    let coordinations = [structure.k, structure.k_hat, structure.z].into_iter().flatten();
    let highest = coordinations.fold(0.0, f64::max);
    add(highest > CLOSE_PACKING, Warning::CoordinationImpossible { coordination: highest });
    if let Some(range) = calibration.pressures() {
        let pressure = observation.pressure();
        // The rounding of a servo is no extrapolation.
        let wide = [0.99 * range[0], 1.01 * range[1]];
        add(outside(pressure, wide), Warning::PressureOutsideFit { pressure, range });
    }
    if let Some(nu) = conditions.material.map(|m| m.poisson_ratio) {
        let calibrated = calibration.material().poisson_ratio;
        add((nu - calibrated).abs() > 1e-6, Warning::OtherGrains { nu, calibrated });
    }
    if let Some(asymmetry) = observation.asymmetry {
        let scatter = observation.grains.map_or(0.0, |n| SCATTER / f64::from(n.max(1)).sqrt());
        add(asymmetry > scatter.max(ASYMMETRY), Warning::NotTransverselyIsotropic { asymmetry });
    }
    add(observation.moduli.unstable(), Warning::NotOneMedium);
    if let Some(relative) = observation.moduli.imbalance() {
        let errors = observation.covariance.as_ref();
        let stddev = errors.and_then(|c| observation.moduli.imbalance_stddev(c)).unwrap_or(0.0);
        add(relative.abs() > ROUNDING + CERTAIN * stddev, Warning::Imbalance { relative });
    }
    for quantity in [Quantity::K, Quantity::Z] {
        let Some(value) = structure.get(quantity) else { continue };
        add(value < 1.0, Warning::CoordinationAbsurd { quantity, value });
    }
    if let Some(covariance) = &observation.covariance {
        let relative = |(modulus, value): (Modulus, f64)| {
            let i = modulus as usize;
            (modulus, covariance[(i, i)].max(0.0).sqrt() / value.abs())
        };
        // C13 is a small difference, and its error tells nothing.
        let given = observation.moduli.known().filter(|(m, _)| *m != Modulus::C13).map(relative);
        if let Some((modulus, relative)) = given.max_by(|a, b| a.1.total_cmp(&b.1)) {
            add(relative > LARGE_ERROR, Warning::ErrorsLarge { modulus, relative });
        }
    }
    if let Some(eps) = structure.eps {
        add(outside(eps, [-0.5, 1.0]), Warning::EpsOutOfRange { eps });
    }
    if uses_gamma {
        let g = conditions.gamma.value;
        add(outside(g, [-0.3, 0.1]), Warning::GammaLarge { g });
        add(outside(g, [-0.5, 0.25]), Warning::ContactsOpen { g });
        add(conditions.gamma.source == GammaSource::Zero, Warning::GammaAssumedZero);
    }
    warnings
}
