//! The contact law of a scene.

use crate::table::Reader;
use grainlab_core::contact::ContactLaw;

/// Reads the table `[contact]`: `law` and the parameters of that law.
pub(crate) fn read(r: &mut Reader<'_>) -> ContactLaw {
    let laws = ContactLaw::examples().map(|law| (law.name(), law));
    let kind = r.choice("law", ContactLaw::default(), &laws);
    let list = kind.parameter_list().iter();
    let positive = |v: f64| v > 0.0 && v.is_finite();
    let parameters: Vec<f64> = list.map(|p| r.number(p.key, p.default, p.meaning, positive)).collect();
    // Invalid parameters are among the faults of the scene already.
    ContactLaw::new(kind.name(), &parameters).unwrap_or_default()
}
