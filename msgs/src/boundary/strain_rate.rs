//! `StrainRate`: the answer to one request.

use super::check::{Check, header};
use super::error::BoundaryError;
use crate::builtin_interfaces::Time;
use crate::msg::StrainRate;

const CHECK: Check = Check("StrainRate");

/// The answer to one request. Voigt order xx, yy, zz, yz, xz, xy, tensor components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainRateAnswer {
    /// Stamp of the request.
    pub stamp: Time,
    /// Sequence number of the request.
    pub sequence: u64,
    /// Strain rate, 1/s, positive in extension.
    pub rate: [f64; 6],
    /// For each component, whether it was limited to the rate limit.
    pub saturated: [bool; 6],
}

impl TryFrom<&StrainRate> for StrainRateAnswer {
    type Error = BoundaryError;

    fn try_from(m: &StrainRate) -> Result<Self, BoundaryError> {
        CHECK.header(&m.header)?;
        Ok(Self {
            stamp: m.header.stamp,
            sequence: m.sequence,
            rate: CHECK.six("rate", &m.rate)?,
            saturated: m.saturated,
        })
    }
}

impl TryFrom<&StrainRateAnswer> for StrainRate {
    type Error = BoundaryError;

    fn try_from(a: &StrainRateAnswer) -> Result<Self, BoundaryError> {
        CHECK.six("rate", &a.rate)?;
        Ok(StrainRate { header: header(a.stamp), sequence: a.sequence, rate: a.rate, saturated: a.saturated })
    }
}
