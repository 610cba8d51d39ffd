//! `RunState`: phase and progress of the run.

use super::check::Check;
use super::error::BoundaryError;
use crate::exit::Exit;
use crate::msg::RunState;

const CHECK: Check = Check("RunState");

const EXITS: &str =
    "0 (done), 1 (failure), 2 (wrong usage), 3 (data loss), 4 (physics invalid), 130 (interrupted)";

impl RunState {
    /// The message, if it is valid.
    ///
    /// # Errors
    /// If the state or the exit code is unknown, the progress is not in 0 … 1, or the stamp is invalid.
    pub fn checked(&self) -> Result<&Self, BoundaryError> {
        CHECK.header(&self.header)?;
        if ![Self::RUNNING, Self::FINISHED, Self::FAILED].contains(&self.state) {
            return Err(CHECK.code("state", self.state, "0 (running), 1 (finished), 2 (failed)"));
        }
        CHECK.share("progress", self.progress)?;
        for code in &self.exit_code {
            Exit::from_code((*code).into()).ok_or_else(|| CHECK.code("exit_code", *code, EXITS))?;
        }
        Ok(self)
    }

    /// Returns the exit of the run by the results of its last packing, once that is known.
    pub fn exit(&self) -> Option<Exit> {
        Exit::from_code((*self.exit_code.first()?).into())
    }

    /// Step of the last packing, if one was published.
    pub fn last_packing(&self) -> Option<u64> {
        (self.packings > 0).then_some(self.last_packing_step)
    }
}
