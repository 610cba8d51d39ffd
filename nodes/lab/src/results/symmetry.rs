//! The symmetry of a stiffness, with the stable keys of `grainlab analyze`.

use grainlab_core::{Stiffness, SymmetryClass, Vec3, symmetry};
use serde::Serialize;

/// The class, the axis of the nearest transversely isotropic stiffness, and how near each class comes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct SymmetryView {
    /// `isotropic`, `cubic`, `transversely isotropic`, `orthotropic` or `lower`.
    pub(crate) class: &'static str,
    /// Largest residual that counts as noise: what packings of as many grains scatter by.
    pub(crate) tolerance: f64,
    pub(crate) axis: [f64; 3],
    /// Between this axis and that of the fabric; null where either means nothing.
    pub(crate) angle_to_fabric_rad: Option<f64>,
    pub(crate) residuals: ResidualsView,
    /// Moduli about that axis.
    pub(crate) about_axis: AboutAxis,
    /// Residual of the projection about z, which G12 and G13 are of.
    pub(crate) residual_about_z: f64,
}

/// Distance to the nearest stiffness of each class, relative, Mandel norm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct ResidualsView {
    pub(crate) isotropic: f64,
    pub(crate) cubic: f64,
    pub(crate) transversely_isotropic: f64,
    pub(crate) orthotropic: f64,
}

/// The transversely isotropic projection about the axis found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct AboutAxis {
    pub(crate) c11_pa: f64,
    pub(crate) c12_pa: f64,
    pub(crate) c13_pa: f64,
    pub(crate) c33_pa: f64,
    pub(crate) g12_pa: f64,
    pub(crate) g13_pa: f64,
}

impl SymmetryView {
    /// Of a packing of `grains` whose fabric has the axis `fabric_axis`, if that is determined; `None` for a stiffness of zero.
    pub(crate) fn new(c: &Stiffness, grains: u32, fabric_axis: Option<&Vec3>) -> Option<Self> {
        let s = symmetry(c, grainlab_micromechanics::symmetry::sampling_tolerance(grains))?;
        let with_axis = s.class != SymmetryClass::Isotropic && s.class != SymmetryClass::Cubic;
        let angle = |a: &Vec3| s.axis.cross(a).norm().atan2(s.axis.dot(a).abs());
        Some(Self {
            class: s.class.name(),
            tolerance: s.tolerance,
            axis: s.axis.into(),
            angle_to_fabric_rad: fabric_axis.filter(|_| with_axis).map(angle),
            residuals: ResidualsView {
                isotropic: s.isotropic,
                cubic: s.cubic,
                transversely_isotropic: s.transversely_isotropic,
                orthotropic: s.orthotropic,
            },
            about_axis: AboutAxis {
                c11_pa: s.moduli.c11,
                c12_pa: s.moduli.c12,
                c13_pa: s.moduli.c13,
                c33_pa: s.moduli.c33,
                g12_pa: s.moduli.g12,
                g13_pa: s.moduli.g13,
            },
            residual_about_z: c.transverse_isotropy().residual,
        })
    }
}
