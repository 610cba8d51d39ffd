//! `Symmetry`: the symmetry of a stiffness, as a message and checked.

use super::check::{Check, row_major, vector_message};
use super::error::BoundaryError;
use crate::msg;
use grainlab_core::{Mat3, Symmetry, SymmetryClass, TransverseIsotropy};

const CHECK: Check = Check("PackingReport.symmetry");

const CLASSES: [(SymmetryClass, u8); 5] = [
    (SymmetryClass::Isotropic, msg::Symmetry::CLASS_ISOTROPIC),
    (SymmetryClass::Cubic, msg::Symmetry::CLASS_CUBIC),
    (SymmetryClass::TransverselyIsotropic, msg::Symmetry::CLASS_TRANSVERSELY_ISOTROPIC),
    (SymmetryClass::Orthotropic, msg::Symmetry::CLASS_ORTHOTROPIC),
    (SymmetryClass::Lower, msg::Symmetry::CLASS_LOWER),
];

pub(super) fn symmetry_message(s: &Symmetry) -> msg::Symmetry {
    let TransverseIsotropy { c11, c12, c13, c33, g13, g12, residual } = s.moduli;
    msg::Symmetry {
        symmetry_class: CLASSES
            .iter()
            .find(|(class, _)| *class == s.class)
            .map_or(u8::MAX, |(_, code)| *code),
        tolerance: s.tolerance,
        isotropic: s.isotropic,
        cubic: s.cubic,
        transversely_isotropic: s.transversely_isotropic,
        orthotropic: s.orthotropic,
        axis: vector_message(&s.axis),
        moduli: msg::TransverseIsotropy { c11, c12, c13, c33, g13, g12, residual },
        cubic_axes: row_major(&s.cubic_axes),
        orthotropic_axes: row_major(&s.orthotropic_axes),
    }
}

pub(super) fn symmetry(m: &msg::Symmetry) -> Result<Symmetry, BoundaryError> {
    let class = CLASSES.iter().find(|(_, code)| *code == m.symmetry_class).map(|(class, _)| *class);
    let axes = |field: &str, values: &[f64; 9]| {
        CHECK.all_finite(field, values)?;
        Ok::<_, BoundaryError>(Mat3::from_row_slice(values))
    };
    let msg::TransverseIsotropy { c11, c12, c13, c33, g13, g12, residual } = m.moduli;
    CHECK.all_finite("moduli", &[c11, c12, c13, c33, g13, g12, residual])?;
    Ok(Symmetry {
        class: class.ok_or_else(|| {
            let known = "0 (isotropic), 1 (cubic), 2 (transversely isotropic), 3 (orthotropic), 4 (lower)";
            CHECK.code("symmetry_class", m.symmetry_class, known)
        })?,
        tolerance: CHECK.not_negative("tolerance", m.tolerance)?,
        isotropic: CHECK.not_negative("isotropic", m.isotropic)?,
        cubic: CHECK.not_negative("cubic", m.cubic)?,
        transversely_isotropic: CHECK.not_negative("transversely_isotropic", m.transversely_isotropic)?,
        orthotropic: CHECK.not_negative("orthotropic", m.orthotropic)?,
        axis: CHECK.unit("axis", &m.axis)?,
        moduli: TransverseIsotropy { c11, c12, c13, c33, g13, g12, residual },
        cubic_axes: axes("cubic_axes", &m.cubic_axes)?,
        orthotropic_axes: axes("orthotropic_axes", &m.orthotropic_axes)?,
    })
}
