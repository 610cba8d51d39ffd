//! Parts of the model without effect in a phase, which are left out.

use grainlab_core::contact::ContactLaw;
use grainlab_dem::roofline::operations_per_contact;
use grainlab_dem::{EngineSettings, Features};

/// Description of the parts left out under these settings, and of the remaining operations per contact. `equal_sized`:
/// all grains have one size.
pub(crate) fn left_out(law: ContactLaw, settings: &EngineSettings, equal_sized: bool) -> String {
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
    let whole = operations_per_contact(law, &EngineSettings { friction: 0.5, ..*settings });
    let left = operations_per_contact(law, settings);
    // A contact below the friction limit takes fewer operations than a sliding one, though nothing is left
    // out.
    let saved = if left < whole && settings.features() != Features::Sliding {
        format!(" ({left:.0} of {whole:.0} operations per contact)")
    } else {
        String::new()
    };
    format!("without {}{saved}", parts.join(", "))
}
