//! `Microstructure`: what was inferred.

use super::BoundaryError;
use super::check::Check;
use crate::builtin_interfaces::Time;
use crate::msg::{Estimate, Microstructure};

/// What was inferred from one set of data, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct MicrostructureReading {
    /// Stamp of the data.
    pub stamp: Time,
    /// Step of the packing the data came from.
    pub source_step: u64,
    /// Topic the data came from.
    pub source: String,
    /// One estimate a model.
    pub estimates: Vec<EstimateReading>,
}

/// What one model inferred, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimateReading {
    /// Name of the model.
    pub model: String,
    /// Name of the isotropic calibration.
    pub calibration: String,
    /// How it went.
    pub status: EstimateStatus,
    /// The values; `None` unless the status is `Ok` or `Extrapolated`.
    pub inferred: Option<Inferred>,
    /// For a reader.
    pub warnings: Vec<String>,
}

/// How an inversion went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EstimateStatus {
    /// Inside the range the model was made for.
    Ok,
    /// A solution outside that range.
    Extrapolated,
    /// The data do not determine the answer.
    Undetermined,
    /// No solution.
    Failed,
}

/// Inferred values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inferred {
    /// Coordination number k in the calibration's sense.
    pub k: f64,
    /// Coordination number k̂ of the equivalent isotropic packing.
    pub k_hat: f64,
    /// Fabric anisotropy ε.
    pub eps: f64,
    /// Covariance of (k, k̂, ε), row-major.
    pub covariance: Option<[f64; 9]>,
    /// Credible intervals.
    pub interval: Option<Interval>,
}

/// Credible intervals, each (low, high).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Probability inside each, between 0 and 1.
    pub level: f64,
    /// Of k.
    pub k: (f64, f64),
    /// Of k̂.
    pub k_hat: (f64, f64),
    /// Of ε.
    pub eps: (f64, f64),
}

impl TryFrom<&Microstructure> for MicrostructureReading {
    type Error = BoundaryError;

    fn try_from(m: &Microstructure) -> Result<Self, BoundaryError> {
        Check("Microstructure").header(&m.header)?;
        Ok(Self {
            stamp: m.header.stamp,
            source_step: m.source_step,
            source: m.source.clone(),
            estimates: m.estimates.iter().map(EstimateReading::try_from).collect::<Result<_, _>>()?,
        })
    }
}

const CHECK: Check = Check("Estimate");

impl TryFrom<&Estimate> for EstimateReading {
    type Error = BoundaryError;

    fn try_from(m: &Estimate) -> Result<Self, BoundaryError> {
        let status = match m.status {
            Estimate::STATUS_OK => EstimateStatus::Ok,
            Estimate::STATUS_EXTRAPOLATED => EstimateStatus::Extrapolated,
            Estimate::STATUS_UNDETERMINED => EstimateStatus::Undetermined,
            Estimate::STATUS_FAILED => EstimateStatus::Failed,
            other => {
                let allowed = "0 (ok), 1 (extrapolated), 2 (undetermined), 3 (failed)";
                return Err(CHECK.code("status", other, allowed));
            }
        };
        let has_values = matches!(status, EstimateStatus::Ok | EstimateStatus::Extrapolated);
        Ok(Self {
            model: m.model.clone(),
            calibration: m.calibration.clone(),
            status,
            inferred: if has_values { Some(inferred(m)?) } else { None },
            warnings: m.warnings.clone(),
        })
    }
}

fn inferred(m: &Estimate) -> Result<Inferred, BoundaryError> {
    Ok(Inferred {
        k: CHECK.finite("k", m.k)?,
        k_hat: CHECK.finite("k_hat", m.k_hat)?,
        eps: CHECK.finite("eps", m.eps)?,
        covariance: CHECK.covariance("covariance", &m.covariance)?,
        interval: interval(m)?,
    })
}

fn interval(m: &Estimate) -> Result<Option<Interval>, BoundaryError> {
    let level = CHECK.share("credible_level", m.credible_level)?;
    if level == 0.0 {
        return Ok(None);
    }
    CHECK.all_finite("interval", &m.interval)?;
    for low in [0, 2, 4] {
        let ordered = m.interval[low] <= m.interval[low + 1];
        let name = format!("interval[{low}]");
        CHECK.that(ordered, &name, m.interval[low], "at most the upper bound that follows it")?;
    }
    let [k_low, k_high, hat_low, hat_high, eps_low, eps_high] = m.interval;
    Ok(Some(Interval { level, k: (k_low, k_high), k_hat: (hat_low, hat_high), eps: (eps_low, eps_high) }))
}
