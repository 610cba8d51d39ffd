//! What a model infers.

use crate::calibration::Calibration;
use crate::observation::{Gamma, GammaSource};
use grains::Mat3;
use std::fmt;

/// Level of the intervals of an [`Estimate`].
pub const CREDIBLE_LEVEL: f64 = 0.95;

/// Half width, in standard deviations, of the central interval of a normal distribution at [`CREDIBLE_LEVEL`].
const HALF_WIDTH: f64 = 1.959_963_984_540_054;

/// Coordination number of a close packing of equal spheres: more contacts than that find no room.
const CLOSE_PACKING: f64 = 12.0;

/// Microstructure, as the models see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Structure {
    /// Coordination number k, in the sense of the calibration.
    pub k: f64,
    /// Coordination number k̂ of the equivalent isotropic packing.
    pub k_hat: f64,
    /// Contact anisotropy ε about e3.
    pub eps: f64,
}

/// Whether an estimate stays inside what its model and calibration were made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// It does.
    Ok,
    /// It does not; the warnings say where.
    Extrapolated,
}

/// What to keep in mind about an estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Warning {
    /// k̂ lies below the packings of the calibration.
    CoordinationBelowFit {
        /// k̂ inferred.
        k_hat: f64,
        /// Lowest k̂ of the calibration.
        limit: f64,
    },
    /// k or k̂ is more than equal spheres find room for.
    CoordinationImpossible {
        /// The larger of k and k̂.
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
}

impl Warning {
    /// Whether the model or the calibration is used outside its range.
    pub fn is_extrapolation(&self) -> bool {
        !matches!(self, Warning::GammaAssumedZero)
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::CoordinationBelowFit { k_hat, limit } => {
                write!(
                    f,
                    "k_hat = {k_hat:.3} is below {limit}, the lowest that the calibration was fitted to"
                )
            }
            Warning::CoordinationImpossible { coordination } => {
                write!(
                    f,
                    "a coordination number of {coordination:.3} is more than equal spheres find room for (12)"
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
        }
    }
}

/// What one model infers from one observation.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Name of the model.
    pub model: &'static str,
    /// Name of the calibration.
    pub calibration: String,
    /// The γ/Δ it was fed with.
    pub gamma: Gamma,
    /// The most probable k, k̂ and ε.
    pub structure: Structure,
    /// Covariance of (k, k̂, ε), first order in the errors of the observation; `None` if those are not known. Errors of
    /// the model and of the calibration are not in it.
    pub covariance: Option<Mat3>,
    /// Whether model and calibration were used inside their range.
    pub status: Status,
    /// What to keep in mind.
    pub warnings: Vec<Warning>,
}

impl Estimate {
    /// Standard deviations of (k, k̂, ε); `None` if not known.
    pub fn stddev(&self) -> Option<[f64; 3]> {
        let c = self.covariance.as_ref()?;
        Some(std::array::from_fn(|i| c[(i, i)].max(0.0).sqrt()))
    }

    /// Central intervals of k, k̂ and ε at [`CREDIBLE_LEVEL`], low and high, errors taken as normal; `None` if the
    /// uncertainty is not known.
    pub fn interval(&self) -> Option<[[f64; 2]; 3]> {
        let sigma = self.stddev()?;
        let Structure { k, k_hat, eps } = self.structure;
        let middle = [k, k_hat, eps];
        Some(std::array::from_fn(|i| [middle[i] - HALF_WIDTH * sigma[i], middle[i] + HALF_WIDTH * sigma[i]]))
    }
}

/// The warnings of an estimate of the paper's models with shear ratio `ratio`.
pub(crate) fn warnings(s: &Structure, ratio: f64, gamma: &Gamma, calibration: &Calibration) -> Vec<Warning> {
    let (g, limit) = (gamma.value, calibration.fitted_above());
    let coordination = s.k.max(s.k_hat);
    [
        (s.k_hat < limit, Warning::CoordinationBelowFit { k_hat: s.k_hat, limit }),
        (coordination > CLOSE_PACKING, Warning::CoordinationImpossible { coordination }),
        (!(2.0 / 3.0..=1.5).contains(&ratio), Warning::RatioUnusual { ratio }),
        (!(-0.5..=1.0).contains(&s.eps), Warning::EpsOutOfRange { eps: s.eps }),
        (!(-0.3..=0.1).contains(&g), Warning::GammaLarge { g }),
        (!(-0.5..=0.25).contains(&g), Warning::ContactsOpen { g }),
        (gamma.source == GammaSource::Zero, Warning::GammaAssumedZero),
    ]
    .into_iter()
    .filter_map(|(applies, warning)| applies.then_some(warning))
    .collect()
}
