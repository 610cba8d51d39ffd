//! Values of a packing as they are shown.

use grainlab_core::results::PackingReport;

/// The counted anisotropy; `None` without contacts.
pub(super) fn eps(r: &PackingReport) -> Option<f64> {
    (r.contacts.contacts > 0).then_some(r.fabric.contact_anisotropy)
}

/// G12, G13 and Theta, MPa.
pub fn moduli(r: &PackingReport) -> [Option<f64>; 3] {
    let Some(stiffness) = r.stiffness() else { return [None; 3] };
    let t = stiffness.tensor.transverse_isotropy_about(&r.fabric.reference_axis);
    [t.g12, t.g13, stiffness.tensor.bulk_voigt()].map(|m| Some(m / 1e6))
}
