//! `Microstructure`: the inferred microstructure.

use super::check::Check;
use super::error::BoundaryError;
use super::estimate::EstimateReading;
use crate::builtin_interfaces::Time;
use crate::msg::Microstructure;

/// The checked estimates from one set of data.
#[derive(Clone, Debug, PartialEq)]
pub struct MicrostructureReading {
    /// Stamp of the data.
    pub stamp: Time,
    /// Name of the sample or the measurement; empty: none.
    pub name: String,
    /// Step of the packing of the data.
    pub source_step: u64,
    /// Topic of the data.
    pub source: String,
    /// One estimate per model.
    pub estimates: Vec<EstimateReading>,
}

impl TryFrom<&Microstructure> for MicrostructureReading {
    type Error = BoundaryError;

    fn try_from(m: &Microstructure) -> Result<Self, BoundaryError> {
        Check("Microstructure").header(&m.header)?;
        Ok(Self {
            stamp: m.header.stamp,
            name: m.name.clone(),
            source_step: m.source_step,
            source: m.source.clone(),
            estimates: m.estimates.iter().map(EstimateReading::try_from).collect::<Result<_, _>>()?,
        })
    }
}
