//! What a phase leaves out of the model, because it has no effect there.

use crate::phase_settings::phase_settings;
use grainlab_dem::roofline::operations_per_contact;
use grainlab_dem::{EngineSettings, Features};
use grainlab_scene::{GasMethod, Phase, PhaseKind, Scene};

/// What a phase leaves out, and what of the arithmetic of a contact is left: for people. `equal_sized` tells whether all
/// grains are of one size.
pub(crate) fn left_out(scene: &Scene, phase: &Phase, equal_sized: bool) -> String {
    if matches!(phase.kind, PhaseKind::Gas { method: GasMethod::EventDriven, .. }) {
        return "without the contact law and spins: hard spheres, from collision to collision".into();
    }
    let settings = phase_settings(scene, phase);
    let mut parts = match settings.features() {
        Features::Frictionless => vec!["spins", "tangential springs"],
        Features::Sliding => vec![],
        Features::NoSlip => vec!["the Coulomb check"],
    };
    if equal_sized {
        parts.push("unequal sizes");
    }
    if parts.is_empty() {
        return "with the whole contact law".into();
    }
    let whole = operations_per_contact(scene.law, &EngineSettings { friction: 0.5, ..settings });
    let left = operations_per_contact(scene.law, &settings);
    // A contact that friction holds takes fewer than one that slides, though nothing is left out.
    let saved = if left < whole && settings.features() != Features::Sliding {
        format!(" ({left:.0} of {whole:.0} operations per contact)")
    } else {
        String::new()
    };
    format!("without {}{saved}", parts.join(", "))
}
