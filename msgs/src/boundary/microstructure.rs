//! `Microstructure`: the inferred microstructure.

use super::error::BoundaryError;
use crate::msg::Microstructure;
use grainlab_core::results::Estimate;

impl Microstructure {
    /// The checked estimates, one per model. The stamp only repeats that of the data, which may be refused for it.
    ///
    /// # Errors
    /// An estimate with a number that no reader accepts.
    pub fn results(&self) -> Result<Vec<Estimate>, BoundaryError> {
        self.estimates.iter().map(Estimate::try_from).collect()
    }
}
