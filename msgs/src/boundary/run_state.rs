//! `RunState`: phase and progress of the run.

use super::check::Check;
use super::error::BoundaryError;
use crate::builtin_interfaces::Time;
use crate::msg::RunState;

const CHECK: Check = Check("RunState");

/// Status of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunStatus {
    /// Run under way.
    Running,
    /// The loading path is done.
    Finished,
    /// It ended early; the message has the reason.
    Failed,
}

/// The checked state of the run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunStateReading {
    /// 10⁹ s + simulated time.
    pub stamp: Time,
    /// Status of the run.
    pub status: RunStatus,
    /// Number of the phase in the loading path, from 1.
    pub phase: u32,
    /// Name of the phase.
    pub phase_name: String,
    /// Progress of the loading path, 0 to 1.
    pub progress: f64,
    /// Solver steps done.
    pub step: u64,
    /// Step of the last packing, if one was published.
    pub last_packing_step: Option<u64>,
    /// Packings published so far.
    pub packings: u32,
    /// A note for the user.
    pub message: String,
}

impl TryFrom<&RunState> for RunStateReading {
    type Error = BoundaryError;

    fn try_from(m: &RunState) -> Result<Self, BoundaryError> {
        CHECK.header(&m.header)?;
        let status = match m.state {
            RunState::RUNNING => RunStatus::Running,
            RunState::FINISHED => RunStatus::Finished,
            RunState::FAILED => RunStatus::Failed,
            other => return Err(CHECK.code("state", other, "0 (running), 1 (finished), 2 (failed)")),
        };
        Ok(Self {
            stamp: m.header.stamp,
            status,
            phase: m.phase,
            phase_name: m.phase_name.clone(),
            progress: CHECK.share("progress", m.progress)?,
            step: m.step,
            last_packing_step: (m.packings > 0).then_some(m.last_packing_step),
            packings: m.packings,
            message: m.message.clone(),
        })
    }
}
