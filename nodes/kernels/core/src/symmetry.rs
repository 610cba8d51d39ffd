//! Symmetry of a stiffness, and its axes.
//!
//! A stiffness is compared with the nearest one of each class, in the frame in which that is nearest: the residual of a
//! class is |C − P C|/|C| with P the projection on the class and |·| the norm of the tensor (Mandel norm). Frames are
//! sought, not assumed.

mod frame;
mod projection;

use crate::stiffness::{Stiffness, TransverseIsotropy};
use crate::tensor::{Mat3, Vec3};
use frame::{Search, nearest};

/// Classes of elastic symmetry, the highest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SymmetryClass {
    /// Isotropic: 2 constants.
    Isotropic,
    /// Cubic: 3 constants.
    Cubic,
    /// 5 constants; a hexagonal crystal is one too.
    TransverselyIsotropic,
    /// Orthotropic: 9 constants.
    Orthotropic,
    /// More constants than 9: tetragonal and trigonal ones with 6 or 7 that are not orthotropic, monoclinic, triclinic.
    Lower,
}

/// Result of [`symmetry`]: class, residuals and axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symmetry {
    /// The highest class whose residual is at most [`Symmetry::tolerance`]. Cubic and transversely isotropic, neither of
    /// which contains the other, compete by residual.
    pub class: SymmetryClass,
    /// Largest relative residual that counted as none.
    pub tolerance: f64,
    /// Relative residual of the nearest isotropic stiffness.
    pub isotropic: f64,
    /// Residual of the nearest cubic one.
    pub cubic: f64,
    /// Residual of the nearest transversely isotropic one.
    pub transversely_isotropic: f64,
    /// Residual of the nearest orthotropic one.
    pub orthotropic: f64,
    /// Axis of the nearest transversely isotropic stiffness; unit, z ≥ 0. It means nothing where the class is isotropic.
    pub axis: Vec3,
    /// Moduli of the nearest transversely isotropic stiffness, about [`Symmetry::axis`].
    pub moduli: TransverseIsotropy,
    /// Axes of the nearest cubic stiffness, as columns.
    pub cubic_axes: Mat3,
    /// Axes of the nearest orthotropic stiffness, as columns.
    pub orthotropic_axes: Mat3,
}

impl SymmetryClass {
    /// In words, as in results: `transversely isotropic`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Isotropic => "isotropic",
            Self::Cubic => "cubic",
            Self::TransverselyIsotropic => "transversely isotropic",
            Self::Orthotropic => "orthotropic",
            Self::Lower => "lower",
        }
    }
}

/// Finds the symmetry of `stiffness`, calling a class met whose residual is at most `tolerance` (relative, of the norm).
///
/// Only the symmetric part of the 6×6 matrix is looked at. `None` if it is zero or not finite.
///
/// ```
/// use grainlab_core::{SymmetryClass, symmetry};
/// use grainlab_core::{Stiffness, TransverseIsotropy};
/// let moduli = TransverseIsotropy { c11: 360.0, c12: 80.0, c13: 70.0, c33: 400.0, g13: 150.0, g12: 140.0, residual: 0.0 };
/// let turned = nalgebra::Rotation3::from_euler_angles(0.3, -0.8, 1.9);
/// let found = symmetry(&moduli.stiffness().rotated(turned.matrix()), 1e-6).unwrap();
/// assert_eq!(found.class, SymmetryClass::TransverselyIsotropic);
/// assert!((found.moduli.c33 - 400.0).abs() < 1e-9);
/// ```
pub fn symmetry(stiffness: &Stiffness, tolerance: f64) -> Option<Symmetry> {
    let c = stiffness.mandel();
    let c = (c + c.transpose()) * 0.5;
    let norm = c.norm();
    if !(norm > 0.0 && norm.is_finite()) {
        return None;
    }
    let unit = c / norm;
    let isotropic = (unit - projection::isotropic(&unit)).norm();
    let cubic = nearest(&unit, projection::cubic, Search::Frames);
    let axial = nearest(&unit, projection::transversely_isotropic, Search::Axes);
    let orthotropic = nearest(&unit, projection::orthotropic, Search::Frames);
    let axis = upward(axial.axes.column(2).into_owned());
    let class = if isotropic <= tolerance {
        SymmetryClass::Isotropic
    } else if cubic.residual.min(axial.residual) <= tolerance {
        if cubic.residual < axial.residual {
            SymmetryClass::Cubic
        } else {
            SymmetryClass::TransverselyIsotropic
        }
    } else if orthotropic.residual <= tolerance {
        SymmetryClass::Orthotropic
    } else {
        SymmetryClass::Lower
    };
    Some(Symmetry {
        class,
        tolerance,
        isotropic,
        cubic: cubic.residual,
        transversely_isotropic: axial.residual,
        orthotropic: orthotropic.residual,
        axis,
        moduli: stiffness.transverse_isotropy_about(&axis),
        cubic_axes: cubic.axes,
        orthotropic_axes: orthotropic.axes,
    })
}

/// `axis` or its opposite: the first component that is not zero, from z down, is positive.
fn upward(axis: Vec3) -> Vec3 {
    let sign = [axis.z, axis.y, axis.x].into_iter().find(|c| *c != 0.0).unwrap_or(1.0).signum();
    axis * sign
}
