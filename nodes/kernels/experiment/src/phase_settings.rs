//! The settings of the engine in a phase.

use grainlab_engine::{EngineSettings, TimeStep};
use grainlab_scene::{Phase, PhaseKind, Scene};

pub(crate) fn phase_settings(scene: &Scene, phase: &Phase) -> EngineSettings {
    EngineSettings {
        friction: phase.friction,
        damping: phase.damping,
        drag: phase.drag,
        spin_drag: phase.spin_drag,
        tangential: scene.numerics.tangential,
        time_step: TimeStep::FractionOfStable(scene.numerics.time_step_safety),
        skin: scene.numerics.skin * scene.sizes.mean(),
        thermostat_speed: match phase.kind {
            PhaseKind::Gas { speed, .. } => Some(speed),
            _ => None,
        },
    }
}
