//! The contact law of a scene.

use crate::table::Reader;
use grainlab_core::contact::{ContactLaw, Linear};

/// Reads the table `[contact]`: `law` and the keys of that law.
pub(crate) fn read(r: &mut Reader<'_>) -> ContactLaw {
    let positive = |v: f64| v > 0.0 && v.is_finite();
    let laws = ContactLaw::examples().map(|law| (law.name(), law));
    match r.choice("law", ContactLaw::default(), &laws) {
        ContactLaw::HertzMindlin => ContactLaw::HertzMindlin,
        ContactLaw::Linear(_) => ContactLaw::Linear(Linear {
            normal_stiffness: r.number("normal_stiffness", None, "a stiffness in N/m, more than 0", positive),
            stiffness_ratio: r.number("stiffness_ratio", Some(0.5), "k_t/k_n, more than 0", positive),
        }),
    }
}
