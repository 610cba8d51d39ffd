//! The contact law of a scene.

use crate::keys;
use crate::reader::Reader;
use grainlab_core::contact::{ContactLaw, Linear};

/// Reads `[contact]`: the law and its keys. Missing keys are those of `default`.
pub(crate) fn read(r: &mut Reader<'_>, default: &ContactLaw) -> ContactLaw {
    let laws = ContactLaw::examples().map(|law| (law.name(), law));
    match r.choice(&keys::CONTACT_LAW, default.name(), &laws) {
        ContactLaw::HertzMindlin => ContactLaw::HertzMindlin,
        ContactLaw::Linear(_) => {
            let known = if let ContactLaw::Linear(law) = default { Some(law) } else { None };
            let ratio = known.map_or(0.5, |law| law.stiffness_ratio);
            ContactLaw::Linear(Linear {
                normal_stiffness: r.number_or(&keys::NORMAL_STIFFNESS, known.map(|l| l.normal_stiffness)),
                stiffness_ratio: r.number_or(&keys::STIFFNESS_RATIO, Some(ratio)),
            })
        }
    }
}
