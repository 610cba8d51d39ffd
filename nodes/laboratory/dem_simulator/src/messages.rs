//! The messages of a run. All their times are simulated time.

use grainlab_engine::{EnergyBalance, EngineError};
use grainlab_experiment::{ExperimentError, Simulation};
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::geometry_msgs::{Quaternion, Transform, TransformStamped};
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::tf2_msgs::TFMessage;
use grainlab_msgs::{Exit, msg, stamp};

/// The number of a phase in messages, from 1, by its index in the scene.
fn number(index: usize) -> u32 {
    index as u32 + 1
}

/// Frame of everything measured in the cell.
const FRAME: &str = "cell";

pub(crate) fn packing(run: &Simulation) -> Result<msg::Packing, ExperimentError> {
    let packing = run.packing()?.validated().map_err(EngineError::from)?;
    Ok(packing_message(&packing, &run.scene().name, run.run_state()?))
}

/// Step and number of the packings published so far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Packings {
    pub(crate) last_step: u64,
    pub(crate) count: u32,
}

/// What a reader is told about the state of the run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Remark {
    pub(crate) text: String,
    /// Exit of the run by the results of its last packing.
    pub(crate) exit: Option<Exit>,
}

impl From<String> for Remark {
    fn from(text: String) -> Self {
        Self { text, exit: None }
    }
}

pub(crate) fn run_state(run: &Simulation, state: u8, packings: Packings, remark: &Remark) -> msg::RunState {
    let phases = &run.scene().phases;
    let phase = run.path().phase.min(phases.len().saturating_sub(1));
    msg::RunState {
        header: Header { stamp: stamp(run.engine().time()), frame_id: FRAME.to_owned() },
        state,
        phase: number(phase),
        phase_name: phases.get(phase).map(|p| p.name.clone()).unwrap_or_default(),
        progress: run.path().progress(run.scene()).clamp(0.0, 1.0),
        step: run.engine().steps(),
        last_packing_step: packings.last_step,
        packings: packings.count,
        message: remark.text.clone(),
        exit_code: remark.exit.iter().map(|exit| exit.code()).collect(),
    }
}

/// The balance of the phase that has just ended.
pub(crate) fn energy(run: &Simulation, phase_name: &str, found: &EnergyBalance) -> msg::EnergyBalance {
    msg::EnergyBalance {
        header: Header { stamp: stamp(run.engine().time()), frame_id: FRAME.to_owned() },
        step: run.engine().steps(),
        phase: number(run.path().phase.saturating_sub(1)),
        phase_name: phase_name.to_owned(),
        start: found.start,
        strain_work: found.strain_work,
        integration: found.integration,
        kinetic: found.kinetic,
        normal_springs: found.normal_springs,
        tangential_springs: found.tangential_springs,
        rolling_springs: found.rolling_springs,
        normal_damping: found.normal_damping,
        tangential_damping: found.tangential_damping,
        rolling_damping: found.rolling_damping,
        sliding: found.sliding,
        rolling: found.rolling,
        history: found.history,
        drag: found.drag,
        thermostat: found.thermostat,
    }
}

/// The cell's frame is at rest in the world frame; viewers need this transform.
pub(crate) fn frames() -> TFMessage {
    let rotation = Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
    let rest = TransformStamped {
        header: Header { stamp: stamp(0.0), frame_id: "world".to_owned() },
        child_frame_id: FRAME.to_owned(),
        transform: Transform { rotation, ..Transform::default() },
    };
    TFMessage { transforms: vec![rest] }
}
