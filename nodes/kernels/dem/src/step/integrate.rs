//! Moves grains and cell over one step.

use crate::domain::accumulator::ChunkForces;
use crate::domain::state::{GrainsMut, State};
use crate::simd::instruction_set::Simd;
use crate::simd::kernel::Kernel;
use crate::simd::simd_f64::{F64x4, F64x8, SimdF64, SimdRow};
use grainlab_core::Mat3;
use grainlab_engine::{EngineSettings, Features};

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SpeedStats {
    /// Largest square of each velocity component, m²/s²; NaN is ignored.
    largest: F64x4,
    /// Sum of the squares of each velocity component, m²/s².
    sum: F64x4,
}

impl SpeedStats {
    /// Upper bound of v² over grains, m²/s².
    pub(crate) fn largest_square_speed(&self) -> f64 {
        self.largest[0] + self.largest[1] + self.largest[2]
    }

    /// Sum of v² over grains, m²/s²; not finite if the state is lost.
    pub(crate) fn sum_square_speed(&self) -> f64 {
        self.sum[0] + self.sum[1] + self.sum[2]
    }

    /// Adds the next grains, in the order of the sum.
    pub(crate) fn add(&mut self, next: &Self) {
        self.sum = add(self.sum, next.sum);
        self.largest = largest(self.largest, next.largest);
    }
}

/// The coefficients of motion, the same for all chunks.
#[derive(Clone, Copy)]
pub(crate) struct Motion<'a> {
    inverse_mass: &'a [f64],
    inverse_inertia: &'a [f64],
    is_monodisperse: bool,
    /// Columns of the strain rate, 1/s.
    rate: [F64x4; 3],
    dt: f64,
    /// Factors of velocity and spin over one step of drag.
    drag_factors: [f64; 2],
    has_spins: bool,
}

impl<'a> Motion<'a> {
    pub(crate) fn of(state: &'a State, settings: &EngineSettings) -> Self {
        // Drag may stop a grain, but must not reverse it.
        let factor = |drag: f64| (1.0 - drag * state.time_step).max(0.0);
        let rate = &state.rate;
        Self {
            inverse_mass: &state.inverse_mass,
            inverse_inertia: &state.inverse_inertia,
            is_monodisperse: state.is_monodisperse(),
            rate: [0, 1, 2].map(|c| [rate[(0, c)], rate[(1, c)], rate[(2, c)], 0.0]),
            dt: state.time_step,
            drag_factors: [factor(settings.drag), factor(settings.spin_drag)],
            has_spins: settings.features() != Features::Frictionless,
        }
    }
}

/// Moves a chunk of grains, of which the first is `first`, over one step.
pub(crate) fn advance<F: ChunkForces>(
    motion: &Motion<'_>,
    forces: F,
    first: usize,
    grains: GrainsMut<'_>,
    simd: Simd,
) -> SpeedStats {
    let motion = *motion;
    macro_rules! run {
        ($spins:literal, $sizes:literal) => {
            simd.run(Move::<F, $spins, $sizes> { motion, forces, first, grains })
        };
    }
    match (motion.has_spins, motion.is_monodisperse) {
        (true, true) => run!(true, false),
        (true, false) => run!(true, true),
        (false, true) => run!(false, false),
        (false, false) => run!(false, true),
    }
}

/// Kick and drift of a chunk: velocities relative to the affine motion (v̇ = F/m − L v), positions with it
/// (ẋ = v + L x), and spins where `SPINS`.
struct Move<'a, F, const SPINS: bool, const SIZES: bool> {
    motion: Motion<'a>,
    forces: F,
    first: usize,
    grains: GrainsMut<'a>,
}

impl<F: ChunkForces, const SPINS: bool, const SIZES: bool> Kernel for Move<'_, F, SPINS, SIZES> {
    type Output = SpeedStats;

    #[inline(always)]
    fn run<L: SimdF64>(self) -> SpeedStats {
        let (m, mut forces) = (self.motion, self.forces);
        let GrainsMut { position, twist } = self.grains;
        let zero = L::Row::splat(0.0);
        let (mut squares, mut largest) = (zero, zero);
        let rate = [L::Row::load(&m.rate[0], 0), L::Row::load(&m.rate[1], 0), L::Row::load(&m.rate[2], 0)];
        let [drag, spin_drag] = m.drag_factors;
        let (dt, drag) = (L::Row::splat(m.dt), [L::Row::splat(drag), L::Row::splat(spin_drag)]);
        let mut inverse = [L::Row::splat(m.inverse_mass[0]), L::Row::splat(m.inverse_inertia[0] * m.dt)];
        for (k, (x, F64x8(t))) in position.iter_mut().zip(twist).enumerate() {
            if SIZES {
                let g = self.first + k;
                inverse = [L::Row::splat(m.inverse_mass[g]), L::Row::splat(m.inverse_inertia[g] * m.dt)];
            }
            let [force, torque] = forces.on::<L::Row>(k);
            let mut v = L::Row::load(t, 0);
            let mut kick = force.mul(inverse[0]);
            for c in 0..3 {
                kick = rate[c].mul_add(L::Row::splat(-t[c]), kick);
            }
            v = kick.mul_add(dt, v).mul(drag[0]);
            let mut drift = v;
            for c in 0..3 {
                drift = rate[c].mul_add(L::Row::splat(x[c]), drift);
            }
            drift.mul_add(dt, L::Row::load(x, 0)).store(x, 0);
            v.store(t, 0);
            if SPINS {
                let w = torque.mul_add(inverse[1], L::Row::load(t, 4));
                w.mul(drag[1]).store(t, 4);
            }
            let square = v.mul(v);
            squares = squares.add(square);
            largest = square.max(largest);
        }
        let mut stats = SpeedStats::default();
        squares.store(&mut stats.sum, 0);
        largest.store(&mut stats.largest, 0);
        stats
    }
}

#[inline(always)]
fn add(a: F64x4, b: F64x4) -> F64x4 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
}

#[inline(always)]
fn largest(a: F64x4, b: F64x4) -> F64x4 {
    let mut result = a;
    for k in 0..4 {
        if b[k] > a[k] {
            result[k] = b[k];
        }
    }
    result
}

/// I + L dt: the deformation of the cell in one step.
pub(crate) fn deformation(state: &State) -> Mat3 {
    Mat3::identity() + state.rate * state.time_step
}
