//! `Microstructure`: the inferred microstructure.

use super::error::BoundaryError;
use super::estimate::ModelResult;
use crate::msg::Microstructure;

/// The checked estimates from one set of data.
#[derive(Clone, Debug, PartialEq)]
pub struct MicrostructureReading {
    /// Name of the sample or the measurement; empty: none.
    pub name: String,
    /// Step of the packing of the data.
    pub source_step: u64,
    /// Topic of the data.
    pub source: String,
    /// One estimate per model.
    pub estimates: Vec<ModelResult>,
}

impl TryFrom<&Microstructure> for MicrostructureReading {
    type Error = BoundaryError;

    fn try_from(m: &Microstructure) -> Result<Self, BoundaryError> {
        // The stamp only repeats that of the data, which may be refused for it.
        Ok(Self {
            name: m.name.clone(),
            source_step: m.source_step,
            source: m.source.clone(),
            estimates: m.estimates.iter().map(ModelResult::try_from).collect::<Result<_, _>>()?,
        })
    }
}
