//! Grains and cell.

use crate::lanes::{Octad, Quad};
use grainlab_core::{Cell, Mat3, Material, Vec3};

/// A row of a table of vectors.
#[inline(always)]
pub(crate) fn row(v: &Vec3) -> Quad {
    [v.x, v.y, v.z, 0.0]
}

/// The vector in a row.
#[inline(always)]
pub(crate) fn vector(row: &Quad) -> Vec3 {
    Vec3::new(row[0], row[1], row[2])
}

/// Velocity and spin in a row.
pub(crate) fn twist(velocity: &Vec3, spin: &Vec3) -> Octad {
    Octad([velocity.x, velocity.y, velocity.z, 0.0, spin.x, spin.y, spin.z, 0.0])
}

/// Everything that moves.
///
/// Positions are those of step n, velocities and spins those that led there (step n − 1/2): the stage at which forces
/// are evaluated, so that a saved state needs nothing else to go on exactly.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub(crate) step: u64,
    pub(crate) time: f64,
    pub(crate) time_step: f64,
    pub(crate) cell: Cell,
    /// Strain rate in force, 1/s, symmetric.
    pub(crate) rate: Mat3,
    pub(crate) material: Material,
    pub(crate) ids: Vec<u32>,
    pub(crate) radius: Vec<f64>,
    pub(crate) inverse_mass: Vec<f64>,
    pub(crate) inverse_inertia: Vec<f64>,
    pub(crate) position: Vec<Quad>,
    /// Velocity relative to the affine motion, m/s, and spin, rad/s.
    pub(crate) twist: Vec<Octad>,
    /// Largest radius, m.
    pub(crate) largest_radius: f64,
    /// Smallest radius, m.
    pub(crate) smallest_radius: f64,
}

impl State {
    pub(crate) fn new(
        cell: Cell,
        material: Material,
        ids: Vec<u32>,
        radius: Vec<f64>,
        position: &[Vec3],
    ) -> Self {
        let n = radius.len();
        let mass = |r: &f64| material.sphere_mass(*r);
        Self {
            step: 0,
            time: 0.0,
            time_step: 0.0,
            cell,
            rate: Mat3::zeros(),
            material,
            ids,
            inverse_mass: radius.iter().map(|r| 1.0 / mass(r)).collect(),
            inverse_inertia: radius.iter().map(|r| 1.0 / (0.4 * mass(r) * r * r)).collect(),
            largest_radius: radius.iter().copied().fold(0.0, f64::max),
            smallest_radius: radius.iter().copied().fold(f64::INFINITY, f64::min),
            radius,
            position: position.iter().map(row).collect(),
            twist: vec![Octad::default(); n],
        }
    }

    pub(crate) fn grains(&self) -> usize {
        self.radius.len()
    }

    /// Whether all grains are of one size.
    pub(crate) fn equal_sized(&self) -> bool {
        self.smallest_radius == self.largest_radius
    }

    /// Velocities, m/s.
    pub(crate) fn velocities(&self) -> impl Iterator<Item = Vec3> {
        self.twist.iter().map(|t| Vec3::new(t.0[0], t.0[1], t.0[2]))
    }

    /// Spins, rad/s.
    pub(crate) fn spins(&self) -> impl Iterator<Item = Vec3> {
        self.twist.iter().map(|t| Vec3::new(t.0[4], t.0[5], t.0[6]))
    }

    /// Largest speed of a grain, m/s.
    pub(crate) fn largest_speed(&self) -> f64 {
        self.twist.iter().map(square_speed).fold(0.0, f64::max).sqrt()
    }

    /// Mean of v² over grains, m²/s².
    pub(crate) fn mean_square_speed(&self) -> f64 {
        self.twist.iter().map(square_speed).sum::<f64>() / self.grains() as f64
    }
}

fn square_speed(Octad(t): &Octad) -> f64 {
    t[0] * t[0] + t[1] * t[1] + t[2] * t[2]
}
