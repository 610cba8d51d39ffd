//! `StrainRate`: the answer to one request.

use super::check::Check;
use super::error::BoundaryError;
use crate::msg::StrainRate;

const CHECK: Check = Check("StrainRate");

impl StrainRate {
    /// The message, if it is valid.
    ///
    /// # Errors
    /// A rate that is not finite, an invalid stamp.
    pub fn checked(&self) -> Result<&Self, BoundaryError> {
        CHECK.header(&self.header)?;
        CHECK.six("rate", &self.rate)?;
        Ok(self)
    }
}
