//! Grains and cell.

use crate::simd::simd_f64::{CHUNK_SIZE, F64x4, F64x8};
use grainlab_core::contact::ContactLaw;
use grainlab_core::{Cell, Mat3, Material, Packing, Vec3};

#[inline(always)]
pub(crate) fn row(v: &Vec3) -> F64x4 {
    [v.x, v.y, v.z, 0.0]
}

#[inline(always)]
pub(crate) fn vector(row: &F64x4) -> Vec3 {
    Vec3::new(row[0], row[1], row[2])
}

fn twist(velocity: &Vec3, spin: &Vec3) -> F64x8 {
    F64x8([velocity.x, velocity.y, velocity.z, 0.0, spin.x, spin.y, spin.z, 0.0])
}

/// Everything that moves.
///
/// Positions are those of step n, velocities and spins those of step n − 1/2, which led there. Forces are evaluated at this
/// stage, so that a saved state needs nothing else to go on exactly.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub(crate) step: u64,
    pub(crate) time: f64,
    pub(crate) time_step: f64,
    pub(crate) cell: Cell,
    /// Strain rate in force, 1/s, symmetric.
    pub(crate) rate: Mat3,
    pub(crate) material: Material,
    pub(crate) law: ContactLaw,
    pub(crate) ids: Vec<u32>,
    pub(crate) radius: Vec<f64>,
    pub(crate) inverse_mass: Vec<f64>,
    pub(crate) inverse_inertia: Vec<f64>,
    pub(crate) position: Vec<F64x4>,
    /// Velocity relative to the affine motion, m/s, and spin, rad/s.
    pub(crate) twist: Vec<F64x8>,
    /// Largest radius, m.
    pub(crate) largest_radius: f64,
    /// Smallest radius, m.
    pub(crate) smallest_radius: f64,
}

impl State {
    pub(crate) fn of(packing: &Packing) -> Self {
        let radius = &packing.radii;
        let mass = |r: &f64| packing.material.sphere_mass(*r);
        Self {
            step: packing.step,
            time: packing.time,
            time_step: packing.time_step,
            cell: packing.cell,
            rate: Mat3::zeros(),
            material: packing.material,
            law: packing.law,
            ids: packing.ids.clone(),
            inverse_mass: radius.iter().map(|r| 1.0 / mass(r)).collect(),
            inverse_inertia: radius.iter().map(|r| 1.0 / (0.4 * mass(r) * r * r)).collect(),
            largest_radius: radius.iter().copied().fold(0.0, f64::max),
            smallest_radius: radius.iter().copied().fold(f64::INFINITY, f64::min),
            radius: radius.clone(),
            position: packing.positions.iter().map(row).collect(),
            twist: packing.velocities.iter().zip(&packing.spins).map(|(v, w)| twist(v, w)).collect(),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.radius.len()
    }

    pub(crate) fn is_monodisperse(&self) -> bool {
        self.smallest_radius == self.largest_radius
    }

    /// Velocities of the grains, m/s.
    pub(crate) fn velocities(&self) -> impl Iterator<Item = Vec3> {
        self.twist.iter().map(|t| Vec3::new(t.0[0], t.0[1], t.0[2]))
    }

    /// Spins of the grains, rad/s.
    pub(crate) fn spins(&self) -> impl Iterator<Item = Vec3> {
        self.twist.iter().map(|t| Vec3::new(t.0[4], t.0[5], t.0[6]))
    }

    /// Largest speed of a grain, m/s.
    pub(crate) fn largest_speed(&self) -> f64 {
        self.twist.iter().map(square_speed).fold(0.0, f64::max).sqrt()
    }

    /// Mean of v² over grains, m²/s².
    pub(crate) fn mean_square_speed(&self) -> f64 {
        self.twist.iter().map(square_speed).sum::<f64>() / self.len() as f64
    }
}

fn square_speed(F64x8(t): &F64x8) -> f64 {
    t[0] * t[0] + t[1] * t[1] + t[2] * t[2]
}

/// Positions and twists of consecutive grains, to be changed.
pub(crate) struct GrainsMut<'a> {
    pub(crate) position: &'a mut [F64x4],
    pub(crate) twist: &'a mut [F64x8],
}

impl GrainsMut<'_> {
    pub(crate) fn split_off_front(&mut self, count: usize) -> Self {
        let (position, positions) = std::mem::take(&mut self.position).split_at_mut(count);
        let (twist, twists) = std::mem::take(&mut self.twist).split_at_mut(count);
        (self.position, self.twist) = (positions, twists);
        Self { position, twist }
    }

    pub(crate) fn copy_from(&mut self, position: &[F64x4], twist: &[F64x8]) {
        self.position.copy_from_slice(position);
        self.twist.copy_from_slice(twist);
    }

    pub(crate) fn chunk(&mut self, c: usize) -> GrainsMut<'_> {
        let range = c * CHUNK_SIZE..((c + 1) * CHUNK_SIZE).min(self.position.len());
        GrainsMut { position: &mut self.position[range.clone()], twist: &mut self.twist[range] }
    }
}
