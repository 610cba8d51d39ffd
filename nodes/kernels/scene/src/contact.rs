//! The contact law of a scene.

use crate::key::Key;
use crate::keys;
use crate::reader::Reader;
use grainlab_core::contact::{ContactLaw, LawParameter, RollingResistance, SpringLaw};

/// Reads `[contact]`: the law and its keys. Missing keys are those of `default`.
pub(crate) fn read(r: &mut Reader<'_>, default: &ContactLaw) -> ContactLaw {
    let laws = SpringLaw::EXAMPLES.map(|springs| (springs.name(), springs));
    let springs = r.choice(&keys::CONTACT_LAW, default.name(), &laws);
    let own = keys::LAW_KEYS.iter().find(|(name, _)| *name == springs.name());
    let known = (springs.name() == default.name()).then(|| default.springs.parameters());
    let list = springs.parameter_list();
    let parameters = parameters(r, own.map_or(&[], |(_, keys)| keys), list, known.as_deref());
    let springs = springs.with_parameters(&parameters).unwrap_or(springs);
    ContactLaw { springs, rolling: rolling(r, default.rolling) }
}

fn rolling(r: &mut Reader<'_>, default: Option<RollingResistance>) -> Option<RollingResistance> {
    let keys = &*keys::ROLLING_KEYS;
    if default.is_none() && !keys.iter().any(|key| r.has(key)) {
        keys.iter().for_each(|key| _ = r.get(key));
        return None;
    }
    let known = default.map(|resistance| resistance.parameters());
    let found = parameters(r, keys, &RollingResistance::PARAMETERS, known.as_ref().map(|k| &k[..]));
    found.try_into().ok().map(RollingResistance::from_parameters)
}

/// The parameters of a list: from the scene, else those known, else their defaults.
fn parameters(
    r: &mut Reader<'_>,
    keys: &'static [Key],
    list: &[LawParameter],
    known: Option<&[f64]>,
) -> Vec<f64> {
    let default = |k: usize| known.map_or(list[k].default, |values| Some(values[k]));
    keys.iter().enumerate().map(|(k, key)| r.number(key, default(k))).collect()
}
