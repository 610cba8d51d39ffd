//! Sets of rays.
//!
//! A packing of a few thousand grains is not quite isotropic about any axis: moduli along different azimuths differ by some
//! per cent. The transversely isotropic projection of its stiffness is their average over all azimuths, and a stiffness has
//! harmonics up to the fourth. So do three rays across the axis, 60° apart (their opposites are the same rays), and five at
//! 45° to it, 72° apart, have the projection's moduli in the mean, exactly. Lattice planes are where they are: rays normal to
//! them have four azimuths across the axis, and twice four between, whose fourth harmonics have opposite signs.

use crate::ray::Ray;
use grainlab_core::{Cell, Vec3};
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// Which rays are sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Survey {
    /// One along the axis, three across, five at 45°; of lattice planes one, four and eight.
    #[default]
    Complete,
    /// One along the axis, one across, one between: what a laboratory has transducers for. What a packing differs by between
    /// azimuths they do not tell.
    Three,
    /// Thirteen over the hemisphere, for an axis that is not known: edges, face diagonals and body diagonals of a cube.
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

impl Modes {
    fn of(&self, [along, in_plane, across]: [Vec3; 3]) -> Vec<Vec3> {
        match self {
            Self::All => vec![along, in_plane, across],
            Self::Compression => vec![along],
            Self::Shear => vec![in_plane, across],
        }
    }
}

/// Edges, face diagonals, body diagonals of a cell: of two opposite ones, one.
const EVERYWHERE: [[i32; 3]; 13] = [
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
    /// Rays in the directions wanted, about the unit vector `axis`.
    pub fn rays(&self, axis: &Vec3, modes: Modes) -> Vec<Ray> {
        let [axis, across, other] = Ray::motions_about(axis, axis);
        let at = |from_axis: f64, azimuth: f64| {
            from_axis.cos() * axis + from_axis.sin() * (azimuth.cos() * across + azimuth.sin() * other)
        };
        let directions: Vec<Vec3> = match self {
            Self::Complete => std::iter::once(axis)
                .chain((0..3).map(|k| at(0.5 * PI, f64::from(k) * PI / 3.0)))
                .chain((0..5).map(|k| at(FRAC_PI_4, f64::from(k) * TAU / 5.0)))
                .collect(),
            Self::Three => vec![axis, at(0.5 * PI, 0.0), at(FRAC_PI_4, 0.0)],
            Self::Everywhere => EVERYWHERE.map(|i| Vec3::from(i.map(f64::from)).normalize()).to_vec(),
        };
        let ray = |direction: Vec3| Ray {
            direction,
            indices: None,
            motions: modes.of(Ray::motions_about(&direction, &axis)),
        };
        directions.into_iter().map(ray).collect()
    }

    /// Rays normal to lattice planes of `cell`, with the motions of a medium that is isotropic about `axis`.
    pub fn lattice_rays(&self, cell: &Cell, axis: &Vec3, modes: Modes) -> Vec<Ray> {
        let indices: Vec<[i32; 3]> = match self {
            Self::Complete | Self::Everywhere => EVERYWHERE.to_vec(),
            // Those that are nearest to the axis, to across it, and to 45°.
            Self::Three => [1.0, 0.0, FRAC_PI_4.cos()].map(|cosine| nearest(cell, axis, cosine)).to_vec(),
        };
        let ray = |indices: &[i32; 3]| {
            let direction = Ray::normal(cell, *indices)?;
            let motions = modes.of(Ray::motions_about(&direction, axis));
            Some(Ray { direction, indices: Some(*indices), motions })
        };
        indices.iter().filter_map(ray).collect()
    }
}

/// Of the lattice planes tried, those whose normal is nearest to this cosine from the axis; the first of equals.
fn nearest(cell: &Cell, axis: &Vec3, cosine: f64) -> [i32; 3] {
    let off = |indices: &[i32; 3]| {
        let normal = Ray::normal(cell, *indices).unwrap_or_else(Vec3::zeros);
        let angle = normal.dot(axis).abs().min(1.0).acos();
        // Angles that differ by less than the edges of a servoed cell are off count as equal.
        ((angle - cosine.acos()).abs() * 20.0).round()
    };
    EVERYWHERE.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(EVERYWHERE[0])
}
