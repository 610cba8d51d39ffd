//! Moving grains and cell over one step.

use crate::contacts::{CHUNK, Contacts};
use crate::engine::{Features, Setting};
use crate::lanes::{Lanes, Quad};
use crate::simd::{Kernel, Simd};
use crate::state::State;
use grains::Mat3;

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
    /// Columns of the strain rate, 1/s.
    rate: [Quad; 3],
    dt: f64,
    keep: f64,
    keep_spin: f64,
    friction: bool,
}

/// The moving part of some grains.
pub(crate) struct Grains<'a> {
    position: &'a mut [Quad],
    velocity: &'a mut [Quad],
    spin: &'a mut [Quad],
}

impl<'a> Motion<'a> {
    /// Splits a state into what moves and how.
    pub(crate) fn of(state: &'a mut State, setting: &Setting) -> (Self, Grains<'a>) {
        let State { position, velocity, spin, inverse_mass, inverse_inertia, rate, time_step: dt, .. } =
            state;
        let motion = Self {
            inverse_mass,
            inverse_inertia,
            rate: [0, 1, 2].map(|c| [rate[(0, c)], rate[(1, c)], rate[(2, c)], 0.0]),
            dt: *dt,
            // Drag stops a grain, it never turns it round.
            keep: (1.0 - setting.drag * *dt).max(0.0),
            keep_spin: (1.0 - setting.spin_drag * *dt).max(0.0),
            friction: setting.features() != Features::Frictionless,
        };
        (motion, Grains { position, velocity, spin })
    }
}

impl<'a> Grains<'a> {
    /// Chunks of `size` grains.
    pub(crate) fn chunks(self, size: usize) -> impl Iterator<Item = Grains<'a>> {
        let rows = self.position.chunks_mut(size).zip(self.velocity.chunks_mut(size));
        rows.zip(self.spin.chunks_mut(size)).map(|((position, velocity), spin)| Grains {
            position,
            velocity,
            spin,
        })
    }

    /// Chunk `c` of `size` grains.
    pub(crate) fn chunk(self, c: usize, size: usize) -> Self {
        let range = c * size..((c + 1) * size).min(self.position.len());
        Self {
            position: &mut self.position[range.clone()],
            velocity: &mut self.velocity[range.clone()],
            spin: &mut self.spin[range],
        }
    }
}

/// Moves a chunk of grains, of which the first is `first`, over one step.
pub(crate) fn advance(
    motion: &Motion<'_>,
    contacts: &Contacts,
    first: usize,
    grains: Grains<'_>,
    simd: Simd,
) -> Moved {
    let motion = *motion;
    macro_rules! run {
        ($friction:literal, $sizes:literal) => {
            simd.run(Move::<$friction, $sizes> { motion, contacts, first, grains })
        };
    }
    match (motion.friction, contacts.sizes.is_empty()) {
        (true, true) => run!(true, false),
        (true, false) => run!(true, true),
        (false, true) => run!(false, false),
        (false, false) => run!(false, true),
    }
}

/// Kick and drift of a chunk: velocities relative to the affine motion (v̇ = F/m − L v), positions with it
/// (ẋ = v + L x), spins where there is friction.
struct Move<'a, const FRICTION: bool, const SIZES: bool> {
    motion: Motion<'a>,
    contacts: &'a Contacts,
    first: usize,
    grains: Grains<'a>,
}

impl<const FRICTION: bool, const SIZES: bool> Kernel for Move<'_, FRICTION, SIZES> {
    type Output = Moved;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Moved {
        let m = self.motion;
        let c = self.contacts;
        let dt = [m.dt; 4];
        let mut moved = Moved::default();
        let Grains { position, velocity, spin } = self.grains;
        let (found, far) = c.found(self.first / CHUNK, position.len());
        let mut sums = [[0.0; 8]; CHUNK];
        sums[..found.len()].copy_from_slice(found);
        for &(row, grain) in far {
            let (sum, row) = (&mut sums[grain as usize], &c.sums[row as usize]);
            for k in 0..4 {
                sum[k] += row[k];
            }
            if FRICTION {
                for k in 4..8 {
                    sum[k] += if SIZES { row[k] * row[3] } else { row[k] };
                }
            }
        }
        let rows = position.iter_mut().zip(velocity).zip(spin).zip(&sums);
        for (k, (((position, velocity), spin), sum)) in rows.enumerate() {
            let g = self.first + k;
            let force = [sum[0], sum[1], sum[2], 0.0];
            let torque = [sum[4], sum[5], sum[6], 0.0];
            let inverse_mass = m.inverse_mass[g];
            let kick = sub(mul(force, [inverse_mass; 4]), affine(&m.rate, velocity));
            let v = mul(add(*velocity, mul(kick, dt)), [m.keep; 4]);
            *velocity = v;
            *position = add(*position, mul(add(v, affine(&m.rate, position)), dt));
            if FRICTION {
                let by = m.inverse_inertia[g] * m.dt;
                *spin = mul(add(*spin, mul(torque, [by; 4])), [m.keep_spin; 4]);
            }
            let square = mul(v, v);
            moved.sum = add(moved.sum, square);
            moved.largest = largest(moved.largest, square);
        }
        moved
    }
}

/// L x, from the columns of L.
#[inline(always)]
fn affine(rate: &[Quad; 3], x: &Quad) -> Quad {
    add(add(mul(rate[0], [x[0]; 4]), mul(rate[1], [x[1]; 4])), mul(rate[2], [x[2]; 4]))
}

#[inline(always)]
fn add(a: Quad, b: Quad) -> Quad {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
}

#[inline(always)]
fn sub(a: Quad, b: Quad) -> Quad {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

#[inline(always)]
fn mul(a: Quad, b: Quad) -> Quad {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]]
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
