//! Sets of rays.
//!
//! A packing of a few thousand grains is not exactly isotropic about any axis: moduli along different azimuths differ
//! by some per cent. The transversely isotropic projection of its stiffness is their average over all azimuths, and a
//! stiffness has harmonics up to the fourth. Three rays across the axis, 60° apart (their opposites are the same rays),
//! and five at 45° to it, 72° apart, therefore average exactly to the moduli of the projection. Rays normal to lattice
//! planes have fixed directions: four azimuths across the axis, and twice four between, whose fourth harmonics have
//! opposite signs.

use crate::ray::Ray;
use grainlab_core::{Cell, Vec3};
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// A set of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Survey {
    /// One ray along the axis, three across, five at 45°; normal to lattice planes one, four and eight.
    #[default]
    AzimuthalAverage,
    /// One along the axis, one across, one at 45°, as in a laboratory. Differences between azimuths remain as an error.
    Minimal,
    /// Thirteen over the hemisphere, for an unknown axis: edges, face diagonals and body diagonals of a cube.
    Hemisphere,
}

/// The polarizations sent along each ray.
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

impl Modes {
    fn of(&self, [along, in_plane, across]: [Vec3; 3]) -> Vec<Vec3> {
        match self {
            Self::All => vec![along, in_plane, across],
            Self::Compression => vec![along],
            Self::Shear => vec![in_plane, across],
        }
    }
}

/// Edges, face diagonals, body diagonals of a cell, one of each opposite pair.
const HEMISPHERE: [[i32; 3]; 13] = [
    [0, 0, 1],
    [1, 0, 0],
    [0, 1, 0],
    [1, 1, 0],
    [1, -1, 0],
    [1, 0, 1],
    [-1, 0, 1],
    [0, 1, 1],
    [0, -1, 1],
    [1, 1, 1],
    [1, -1, 1],
    [-1, 1, 1],
    [-1, -1, 1],
];

impl Survey {
    /// Rays in the exact directions, about the unit vector `axis`.
    pub fn rays(&self, axis: &Vec3, modes: Modes) -> Vec<Ray> {
        let [axis, across, other] = Ray::polarizations_about(axis, axis);
        let at = |from_axis: f64, azimuth: f64| {
            from_axis.cos() * axis + from_axis.sin() * (azimuth.cos() * across + azimuth.sin() * other)
        };
        let directions: Vec<Vec3> = match self {
            Self::AzimuthalAverage => std::iter::once(axis)
                .chain((0..3).map(|k| at(0.5 * PI, f64::from(k) * PI / 3.0)))
                .chain((0..5).map(|k| at(FRAC_PI_4, f64::from(k) * TAU / 5.0)))
                .collect(),
            Self::Minimal => vec![axis, at(0.5 * PI, 0.0), at(FRAC_PI_4, 0.0)],
            Self::Hemisphere => HEMISPHERE.map(|i| Vec3::from(i.map(f64::from)).normalize()).to_vec(),
        };
        let ray = |direction: Vec3| Ray {
            direction,
            indices: None,
            polarizations: modes.of(Ray::polarizations_about(&direction, &axis)),
        };
        directions.into_iter().map(ray).collect()
    }

    /// Rays normal to lattice planes of `cell`, with the polarizations of a medium that is isotropic about `axis`.
    pub fn lattice_rays(&self, cell: &Cell, axis: &Vec3, modes: Modes) -> Vec<Ray> {
        let indices: Vec<[i32; 3]> = match self {
            Self::AzimuthalAverage | Self::Hemisphere => HEMISPHERE.to_vec(),
            // The nearest to 0°, 90° and 45° from the axis.
            Self::Minimal => [1.0, 0.0, FRAC_PI_4.cos()].map(|cosine| nearest(cell, axis, cosine)).to_vec(),
        };
        let ray = |indices: &[i32; 3]| {
            let direction = Ray::normal(cell, *indices)?;
            let polarizations = modes.of(Ray::polarizations_about(&direction, axis));
            Some(Ray { direction, indices: Some(*indices), polarizations })
        };
        indices.iter().filter_map(ray).collect()
    }
}

/// The lattice planes whose normal has the nearest angle to the axis, given by its cosine; the first of equals.
fn nearest(cell: &Cell, axis: &Vec3, cosine: f64) -> [i32; 3] {
    let off = |indices: &[i32; 3]| {
        let normal = Ray::normal(cell, *indices).unwrap_or_else(Vec3::zeros);
        let angle = normal.dot(axis).abs().min(1.0).acos();
        // Rounded, so that the small deviations of a servo-controlled cell do not matter.
        ((angle - cosine.acos()).abs() * 20.0).round()
    };
    HEMISPHERE.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(HEMISPHERE[0])
}
