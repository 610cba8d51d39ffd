//! `Microstructure`: the inferred microstructure.

use super::error::BoundaryError;
use super::estimate::ModelResult;
use crate::msg::Microstructure;

impl Microstructure {
    /// The checked estimates, one per model. The stamp only repeats that of the data, which may be refused for it.
    ///
    /// # Errors
    /// An estimate with a number that no reader accepts.
    pub fn results(&self) -> Result<Vec<ModelResult>, BoundaryError> {
        self.estimates.iter().map(ModelResult::try_from).collect()
    }
}
