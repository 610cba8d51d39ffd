//! Sets of rays.
//!
//! A packing of a few thousand grains is not quite isotropic about any axis. What its transversely isotropic projection is,
//! an average over azimuths tells: three rays across the axis and five at 45° to it average out all harmonics that a stiffness
//! has (up to the fourth), so that P and S speeds along them and along the axis have exactly the moduli of the projection.

use crate::ray::Ray;
use grains::{Cell, Vec3};

/// Which rays are sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Survey {
    /// One along the axis, three across, five at 45°; along the lattice planes nearest to these, and more of them, where
    /// the packing must be repeated along the path.
    #[default]
    Complete,
    /// One along the axis, one across, one at 45°: what a laboratory has transducers for.
    Three,
    /// Thirteen over the hemisphere, for an axis that is not known.
    Everywhere,
}

/// Which particle motions are sent along each ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Modes {
    /// P and both S.
    #[default]
    All,
    /// Along the ray only.
    Compression,
    /// Across the ray only.
    Shear,
}

impl Survey {
    /// Rays in any directions, about `axis`.
    pub fn rays(&self, axis: &Vec3, modes: Modes) -> Vec<Ray> {
        let _ = (axis, modes);
        Vec::new()
    }

    /// Rays normal to lattice planes of `cell`, about `axis`.
    pub fn lattice_rays(&self, cell: &Cell, axis: &Vec3, modes: Modes) -> Vec<Ray> {
        let _ = (cell, axis, modes);
        Vec::new()
    }
}
