//! `RunState`: phase and progress of the run.

use super::check::Check;
use super::error::BoundaryError;
use crate::msg::RunState;

const CHECK: Check = Check("RunState");

impl RunState {
    /// The message, if it is valid.
    ///
    /// # Errors
    /// If the state is unknown, the progress is not in 0 … 1, or the stamp is invalid.
    pub fn checked(&self) -> Result<&Self, BoundaryError> {
        CHECK.header(&self.header)?;
        if ![Self::RUNNING, Self::FINISHED, Self::FAILED].contains(&self.state) {
            return Err(CHECK.code("state", self.state, "0 (running), 1 (finished), 2 (failed)"));
        }
        CHECK.share("progress", self.progress)?;
        Ok(self)
    }

    /// Step of the last packing, if one was published.
    pub fn last_packing(&self) -> Option<u64> {
        (self.packings > 0).then_some(self.last_packing_step)
    }
}
