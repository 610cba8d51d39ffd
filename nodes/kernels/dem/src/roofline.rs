//! What the contact law asks of a processor, and what the processor has to give: for benchmarks.

use crate::engine::{Engine, Features, Setting, TimeStep};
use crate::lanes::{BLOCK, CHUNK, Lanes, Octad, Quad, Rows, V3};
use crate::pass::{Frictional, Frictionless};
use crate::simd::{Kernel, Simd};
use crate::sweep;
use grainlab_core::{Cell, Material, Vec3};
use grainlab_scene::Tangential;
use std::cell::Cell as Counter;
use std::hint::black_box;
use std::ops::{Add, Div, Mul, Sub};

thread_local! {
    static OPERATIONS: Counter<u64> = const { Counter::new(0) };
}

/// One lane that counts what is done to it.
#[derive(Clone, Copy)]
struct Counted(f64);

fn counted(value: f64) -> Counted {
    OPERATIONS.set(OPERATIONS.get() + 1);
    Counted(value)
}

macro_rules! count {
    ($($operator:ident $method:ident $sign:tt),*) => {$(
        impl $operator for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                counted(self.0 $sign other.0)
            }
        }
    )*};
}

count!(Add add +, Sub sub -, Mul mul *, Div div /);

impl Lanes for Counted {
    const WIDTH: usize = 1;
    type Mask = bool;
    type Row = Quad;

    fn splat(value: f64) -> Self {
        Self(value)
    }
    fn load(from: &[f64; BLOCK], lane: usize) -> Self {
        Self(from[lane])
    }
    fn store(self, to: &mut [f64; BLOCK], lane: usize) {
        to[lane] = self.0;
    }
    fn mul_add(self, by: Self, plus: Self) -> Self {
        self * by + plus
    }
    fn mul_sub(self, by: Self, minus: Self) -> Self {
        self * by - minus
    }
    fn mul_sub_from(self, by: Self, from: Self) -> Self {
        from - self * by
    }
    fn sqrt(self) -> Self {
        counted(self.0.sqrt())
    }
    fn about_inverse_root(self) -> Self {
        counted(self.0.about_inverse_root())
    }
    fn max(self, other: Self) -> Self {
        counted(<f64 as Lanes>::max(self.0, other.0))
    }
    fn gt(self, other: Self) -> bool {
        OPERATIONS.set(OPERATIONS.get() + 1);
        self.0 > other.0
    }
    fn any(mask: bool) -> bool {
        mask
    }
    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }
    fn are_below(number: &[u32; BLOCK], lane: usize, bound: usize) -> bool {
        f64::are_below(number, lane, bound)
    }
    fn rows(table: &[Quad], at: Rows<'_, Self>) -> V3<Self> {
        let [x, y, z, _] = table[at.number(0)].map(Self);
        V3 { x, y, z }
    }
    fn difference(table: &[Quad], a: Rows<'_, Self>, b: Rows<'_, Self>) -> V3<Self> {
        Self::rows(table, a) - Self::rows(table, b)
    }
    fn relative(table: &[Octad], a: Rows<'_, Self>, b: Rows<'_, Self>) -> [V3<Self>; 2] {
        let (p, q) = (table[a.number(0)].0.map(Self), table[b.number(0)].0.map(Self));
        let velocity = V3 { x: p[0] - q[0], y: p[1] - q[1], z: p[2] - q[2] };
        [velocity, V3 { x: p[4] + q[4], y: p[5] + q[5], z: p[6] + q[6] }]
    }
    fn spins(table: &[Octad], at: Rows<'_, Self>) -> V3<Self> {
        let row = table[at.number(0)].0.map(Self);
        V3 { x: row[4], y: row[5], z: row[6] }
    }
    fn prefetch<T>(_: &[T], _: &[u32; BLOCK]) {}
    fn scatter<const TURN: bool, const LEVERS: bool>(
        c: [Self; 8],
        from: Rows<'_, Self>,
        to: Rows<'_, Self>,
        sums: &mut [Octad],
    ) {
        // One vector on each of two grains, or two with their levers.
        let operations = 6 * (1 + u64::from(TURN) * (1 + u64::from(LEVERS)));
        OPERATIONS.set(OPERATIONS.get() + operations);
        for (row, sign) in [(to.number(0), 1.0), (from.number(0) % CHUNK, -1.0)] {
            for k in 0..3 {
                sums[row].0[k] += sign * c[k].0;
                sums[row].0[4 + k] += c[4 + k].0;
            }
        }
    }
}

/// Floating-point operations (additions, multiplications, divisions, square roots, comparisons; one each) on one sliding
/// contact of grains of one size in one pass, counted by running the law itself.
pub fn operations_per_contact(setting: &Setting) -> f64 {
    // A row of grains with one full block of contacts, sheared hard enough to slide.
    let (radius, grains) = (1e-4, BLOCK + 1);
    let along = |k: usize| Vec3::x() * (1.99 * radius * k as f64);
    let positions: Vec<Vec3> = (0..grains).map(along).collect();
    let Some(cell) = Cell::cube(4.0 * radius * grains as f64) else { return 0.0 };
    let setting = Setting { time_step: TimeStep::Fixed(1e-8), skin: 0.1 * radius, ..*setting };
    let mut engine = Engine::new(cell, Material::GLASS, vec![radius; grains], &positions, setting);
    let aside = |k: usize| Vec3::y() * (100.0 * k as f64);
    engine.set_velocities(&(0..grains).map(aside).collect::<Vec<_>>());
    if engine.prepare().is_err() {
        return 0.0;
    }
    let contacts = &mut engine.contacts;
    let view = sweep::view(&engine.state, contacts.images.shifts(), &setting);
    let Some(share) = contacts.shares.first_mut() else { return 0.0 };
    let mut part = share.part_mut(0);
    let chunk = part.chunk(0);
    let rescaled = setting.tangential == Tangential::Rescaled;
    OPERATIONS.set(0);
    macro_rules! frictional {
        ($sliding:literal, $rescaled:literal) => {
            Frictional::<true, $sliding, $rescaled, false> { view, chunk, look: false }.run::<Counted>()
        };
    }
    match (setting.features(), rescaled) {
        (Features::Frictionless, _) => Frictionless::<false> { view, chunk, look: false }.run::<Counted>(),
        (Features::Coulomb, true) => frictional!(true, true),
        (Features::Coulomb, false) => frictional!(true, false),
        (Features::Stuck, true) => frictional!(false, true),
        (Features::Stuck, false) => frictional!(false, false),
    };
    OPERATIONS.get() as f64 / BLOCK as f64
}

/// Fused multiply-adds (two operations each) that depend on none but their own chain, `rounds` times over: what the
/// processor has to give. Returns how many were done, and a number that
/// hangs on all of them.
pub fn independent_operations(simd: Simd, rounds: u64) -> (u64, f64) {
    simd.run(Chains { rounds })
}

struct Chains {
    rounds: u64,
}

/// Chains at a time: enough to hide the latency of an addition.
const CHAINS: usize = 12;

impl Kernel for Chains {
    type Output = (u64, f64);

    #[inline(always)]
    fn run<L: Lanes>(self) -> (u64, f64) {
        let mut chains = [L::splat(1.0); CHAINS];
        // Unknown to the compiler, which would else see through it.
        let (by, plus) = (L::splat(black_box(0.999_999)), L::splat(black_box(1e-6)));
        for _ in 0..self.rounds {
            for chain in &mut chains {
                *chain = chain.mul_add(by, plus);
            }
        }
        let mut last = [0.0; BLOCK];
        let mut sum = 0.0;
        for chain in chains {
            chain.store(&mut last, 0);
            sum += last[0];
        }
        (self.rounds * 2 * (CHAINS * L::WIDTH) as u64, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_with_more_physics_takes_more_operations() {
        let of = |friction: f64| {
            let setting = Setting {
                friction,
                damping: 0.3,
                drag: 0.0,
                spin_drag: 0.0,
                tangential: Tangential::Rescaled,
                time_step: TimeStep::Fixed(1e-8),
                skin: 0.0,
                speed_cap: None,
            };
            operations_per_contact(&setting)
        };
        assert!(of(0.0) > 30.0);
        assert!(of(f64::INFINITY) > 2.0 * of(0.0));
        assert!(of(0.3) > of(f64::INFINITY));
    }
}
