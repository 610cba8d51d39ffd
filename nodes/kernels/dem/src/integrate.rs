//! Moving grains and cell over one step.

use crate::engine::{Features, Setting};
use crate::lanes::{Lanes, Octad, Quad, Row};
use crate::simd::{Kernel, Simd};
use crate::state::State;
use crate::sums::Act;
use grainlab_core::Mat3;

/// What one step did, for the checks that follow.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moved {
    /// Largest square of each velocity component, m²/s², among those that are numbers.
    largest: Quad,
    /// Sum of the squares of each velocity component, m²/s².
    sum: Quad,
}

impl Moved {
    /// No grain has a larger v², m²/s².
    pub(crate) fn largest_square_speed(&self) -> f64 {
        self.largest[0] + self.largest[1] + self.largest[2]
    }

    /// Sum of v² over grains, m²/s²; not finite if the state is lost.
    pub(crate) fn sum_square_speed(&self) -> f64 {
        self.sum[0] + self.sum[1] + self.sum[2]
    }

    /// This, then what the next grains did.
    pub(crate) fn then(&mut self, next: &Self) {
        self.sum = add(self.sum, next.sum);
        self.largest = largest(self.largest, next.largest);
    }
}

/// How grains move, alike for all chunks.
#[derive(Clone, Copy)]
pub(crate) struct Motion<'a> {
    inverse_mass: &'a [f64],
    inverse_inertia: &'a [f64],
    equal_sized: bool,
    /// Columns of the strain rate, 1/s.
    rate: [Quad; 3],
    dt: f64,
    /// Shares of velocity and spin that drag leaves.
    keep: [f64; 2],
    friction: bool,
}

/// The moving part of some grains.
pub(crate) struct Grains<'a> {
    position: &'a mut [Quad],
    twist: &'a mut [Octad],
}

impl<'a> Motion<'a> {
    /// Splits a state into what moves and how.
    pub(crate) fn of(state: &'a mut State, setting: &Setting) -> (Self, Grains<'a>) {
        let (equal_sized, rate, dt) = (state.equal_sized(), state.rate, state.time_step);
        let State { position, twist, inverse_mass, inverse_inertia, .. } = state;
        let motion = Self::new([inverse_mass, inverse_inertia], equal_sized, &rate, dt, setting);
        (motion, Grains::of(position, twist))
    }

    /// How the grains of a state move, wherever they are.
    pub(crate) fn still(state: &'a State, setting: &Setting) -> Self {
        let inertia = [&state.inverse_mass[..], &state.inverse_inertia];
        Self::new(inertia, state.equal_sized(), &state.rate, state.time_step, setting)
    }

    fn new(
        [inverse_mass, inverse_inertia]: [&'a [f64]; 2],
        equal_sized: bool,
        rate: &Mat3,
        dt: f64,
        setting: &Setting,
    ) -> Self {
        // Drag stops a grain, it never turns it round.
        let left = |drag: f64| (1.0 - drag * dt).max(0.0);
        Self {
            inverse_mass,
            inverse_inertia,
            equal_sized,
            rate: [0, 1, 2].map(|c| [rate[(0, c)], rate[(1, c)], rate[(2, c)], 0.0]),
            dt,
            keep: [left(setting.drag), left(setting.spin_drag)],
            friction: setting.features() != Features::Frictionless,
        }
    }
}

impl<'a> Grains<'a> {
    pub(crate) fn of(position: &'a mut [Quad], twist: &'a mut [Octad]) -> Self {
        Self { position, twist }
    }

    /// The first `count` of those that are left, and leaves the rest.
    pub(crate) fn take(&mut self, count: usize) -> Self {
        let (position, positions) = std::mem::take(&mut self.position).split_at_mut(count);
        let (twist, twists) = std::mem::take(&mut self.twist).split_at_mut(count);
        (self.position, self.twist) = (positions, twists);
        Self { position, twist }
    }

    /// Makes these what others are.
    pub(crate) fn copy(&mut self, position: &[Quad], twist: &[Octad]) {
        self.position.copy_from_slice(position);
        self.twist.copy_from_slice(twist);
    }

    /// Chunk `c` of `size` grains.
    pub(crate) fn chunk(self, c: usize, size: usize) -> Self {
        let range = c * size..((c + 1) * size).min(self.position.len());
        Self { position: &mut self.position[range.clone()], twist: &mut self.twist[range] }
    }
}

/// Moves a chunk of grains, of which the first is `first`, over one step, under what acts on them.
pub(crate) fn advance<A: Act>(
    motion: &Motion<'_>,
    acts: A,
    first: usize,
    grains: Grains<'_>,
    simd: Simd,
) -> Moved {
    let motion = *motion;
    macro_rules! run {
        ($friction:literal, $sizes:literal) => {
            simd.run(Move::<A, $friction, $sizes> { motion, acts, first, grains })
        };
    }
    match (motion.friction, motion.equal_sized) {
        (true, true) => run!(true, false),
        (true, false) => run!(true, true),
        (false, true) => run!(false, false),
        (false, false) => run!(false, true),
    }
}

/// Kick and drift of a chunk: velocities relative to the affine motion (v̇ = F/m − L v), positions with it
/// (ẋ = v + L x), spins where there is friction.
struct Move<'a, A, const FRICTION: bool, const SIZES: bool> {
    motion: Motion<'a>,
    acts: A,
    first: usize,
    grains: Grains<'a>,
}

impl<A: Act, const FRICTION: bool, const SIZES: bool> Kernel for Move<'_, A, FRICTION, SIZES> {
    type Output = Moved;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Moved {
        let (m, mut acts) = (self.motion, self.acts);
        let Grains { position, twist } = self.grains;
        let zero = L::Row::splat(0.0);
        let (mut squares, mut largest) = (zero, zero);
        let rate = [L::Row::load(&m.rate[0], 0), L::Row::load(&m.rate[1], 0), L::Row::load(&m.rate[2], 0)];
        let (dt, keep) = (L::Row::splat(m.dt), [L::Row::splat(m.keep[0]), L::Row::splat(m.keep[1])]);
        let mut by = [L::Row::splat(m.inverse_mass[0]), L::Row::splat(m.inverse_inertia[0] * m.dt)];
        for (k, (x, Octad(t))) in position.iter_mut().zip(twist).enumerate() {
            if SIZES {
                let g = self.first + k;
                by = [L::Row::splat(m.inverse_mass[g]), L::Row::splat(m.inverse_inertia[g] * m.dt)];
            }
            let [force, torque] = acts.on::<L::Row>(k);
            let mut v = L::Row::load(t, 0);
            let mut kick = force.mul(by[0]);
            for c in 0..3 {
                kick = rate[c].mul_add(L::Row::splat(-t[c]), kick);
            }
            v = kick.mul_add(dt, v).mul(keep[0]);
            let mut drift = v;
            for c in 0..3 {
                drift = rate[c].mul_add(L::Row::splat(x[c]), drift);
            }
            drift.mul_add(dt, L::Row::load(x, 0)).store(x, 0);
            v.store(t, 0);
            if FRICTION {
                let w = torque.mul_add(by[1], L::Row::load(t, 4));
                w.mul(keep[1]).store(t, 4);
            }
            let square = v.mul(v);
            squares = squares.add(square);
            largest = square.max(largest);
        }
        let mut moved = Moved::default();
        squares.store(&mut moved.sum, 0);
        largest.store(&mut moved.largest, 0);
        moved
    }
}

#[inline(always)]
fn add(a: Quad, b: Quad) -> Quad {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
}

#[inline(always)]
fn largest(a: Quad, b: Quad) -> Quad {
    let mut most = a;
    for k in 0..4 {
        if b[k] > a[k] {
            most[k] = b[k];
        }
    }
    most
}

/// I + L dt: what the affine motion does to the cell in one step.
pub(crate) fn stretch(state: &State) -> Mat3 {
    Mat3::identity() + state.rate * state.time_step
}
