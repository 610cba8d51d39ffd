//! `Microstructure`: what was inferred.

use super::check::Check;
use super::error::BoundaryError;
use super::estimate::EstimateReading;
use crate::builtin_interfaces::Time;
use crate::msg::Microstructure;

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
