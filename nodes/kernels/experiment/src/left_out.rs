//! Parts of the model without effect in a phase, which are left out.

use grainlab_dem::{EngineSettings, Features};

/// Description of the parts left out under these settings. `equal_sized`: all grains have one size.
pub(crate) fn left_out(settings: &EngineSettings, equal_sized: bool) -> String {
    let mut parts = match settings.features() {
        Features::Frictionless => vec!["spins", "tangential springs"],
        Features::Sliding => vec![],
        Features::NoSlip => vec!["the Coulomb check"],
    };
    if equal_sized {
        parts.push("unequal sizes");
    }
    if parts.is_empty() {
        "with the whole contact law".into()
    } else {
        format!("without {}", parts.join(", "))
    }
}
