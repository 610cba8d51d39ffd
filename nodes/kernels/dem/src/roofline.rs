//! Floating-point operations per contact, and the peak rate of the processor: for benchmarks.

use crate::engine::engine::Engine;
use crate::force::geometry::ForceInput;
use crate::force::kernel::{ForceKernel, Frictional, Frictionless};
use crate::settings::{EngineSettings, Features, TimeStep};
use crate::simd::instruction_set::Simd;
use crate::simd::kernel::Kernel;
use crate::simd::simd_f64::{BLOCK_SIZE, CHUNK_SIZE, CheckedIndices, F64x4, F64x8, SimdF64};
use grainlab_core::contact::{ContactLaw, ContactSprings, LawVisitor, TangentialLaw};
use grainlab_core::lanes::{LaneVec3, Lanes};
use grainlab_core::{Cell, Material, Vec3};
use std::cell::Cell as Counter;
use std::hint::black_box;
use std::ops::{Add, Div, Mul, Sub};

thread_local! {
    static OPERATIONS: Counter<u64> = const { Counter::new(0) };
}

/// One lane that counts its operations.
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
    type Mask = bool;

    fn splat(value: f64) -> Self {
        Self(value)
    }
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }
    fn mul_sub(self, factor: Self, subtrahend: Self) -> Self {
        self * factor - subtrahend
    }
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
        addend - self * factor
    }
    fn sqrt(self) -> Self {
        counted(self.0.sqrt())
    }
    fn rsqrt_estimate(self) -> Self {
        counted(self.0.rsqrt_estimate())
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
}

impl SimdF64 for Counted {
    const WIDTH: usize = 1;
    type Row = F64x4;

    fn load(from: &[f64; BLOCK_SIZE], lane: usize) -> Self {
        Self(from[lane])
    }
    fn store(self, to: &mut [f64; BLOCK_SIZE], lane: usize) {
        to[lane] = self.0;
    }
    fn all_below(indices: &[u32; BLOCK_SIZE], lane: usize, bound: usize) -> bool {
        f64::all_below(indices, lane, bound)
    }
    fn gather(table: &[F64x4], at: CheckedIndices<'_, Self>) -> LaneVec3<Self> {
        let [x, y, z, _] = table[at.get(0)].map(Self);
        LaneVec3 { x, y, z }
    }
    fn gather_difference(
        table: &[F64x4],
        a: CheckedIndices<'_, Self>,
        b: CheckedIndices<'_, Self>,
    ) -> LaneVec3<Self> {
        Self::gather(table, a) - Self::gather(table, b)
    }
    fn gather_relative_motion(
        table: &[F64x8],
        a: CheckedIndices<'_, Self>,
        b: CheckedIndices<'_, Self>,
    ) -> [LaneVec3<Self>; 2] {
        let (p, q) = (table[a.get(0)].0.map(Self), table[b.get(0)].0.map(Self));
        let velocity = LaneVec3 { x: p[0] - q[0], y: p[1] - q[1], z: p[2] - q[2] };
        [velocity, LaneVec3 { x: p[4] + q[4], y: p[5] + q[5], z: p[6] + q[6] }]
    }
    fn gather_spins(table: &[F64x8], at: CheckedIndices<'_, Self>) -> LaneVec3<Self> {
        let row = table[at.get(0)].0.map(Self);
        LaneVec3 { x: row[4], y: row[5], z: row[6] }
    }
    fn prefetch<T>(_: &[T], _: &[u32; BLOCK_SIZE]) {}
    fn scatter_add<const MOMENTS: bool, const LEVERS: bool>(
        c: [Self; 8],
        from: CheckedIndices<'_, Self>,
        to: CheckedIndices<'_, Self>,
        sums: &mut [F64x8],
    ) {
        // One vector on each of two grains, or two with their levers.
        let operations = 6 * (1 + u64::from(MOMENTS) * (1 + u64::from(LEVERS)));
        OPERATIONS.set(OPERATIONS.get() + operations);
        for (row, sign) in [(to.get(0), 1.0), (from.get(0) % CHUNK_SIZE, -1.0)] {
            for k in 0..3 {
                sums[row].0[k] += sign * c[k].0;
                sums[row].0[4 + k] += c[4 + k].0;
            }
        }
    }
}

/// Floating-point operations (additions, multiplications, divisions, square roots, comparisons; one each) of the force kernel
/// per sliding contact of grains of one size, counted by running the kernel itself; 0 for settings or a law out of their range.
pub fn operations_per_contact(law: ContactLaw, settings: &EngineSettings) -> f64 {
    // A row of grains with one full block of contacts, sheared hard enough to slide.
    let (radius, grains) = (1e-4, BLOCK_SIZE + 1);
    let along = |k: usize| Vec3::x() * (1.99 * radius * k as f64);
    let positions: Vec<Vec3> = (0..grains).map(along).collect();
    let Some(cell) = Cell::cube(4.0 * radius * grains as f64) else { return 0.0 };
    let settings = EngineSettings { time_step: TimeStep::Fixed(1e-8), skin: 0.1 * radius, ..*settings };
    let sideways: Vec<Vec3> = (0..grains).map(|k| Vec3::y() * (100.0 * k as f64)).collect();
    let ready = || {
        let engine = Engine::new(cell, Material::GLASS, vec![radius; grains], &positions, settings)?;
        let mut engine = engine.with_law(law)?;
        engine.set_velocities(&sideways)?;
        engine.initialise().map(|()| engine)
    };
    let Ok(mut engine) = ready() else { return 0.0 };
    let (law, material) = (engine.state.law, engine.state.material);
    law.visit(&material, CountOperations { engine: &mut engine, settings: &settings })
}

struct CountOperations<'a> {
    engine: &'a mut Engine,
    settings: &'a EngineSettings,
}

impl LawVisitor for CountOperations<'_> {
    type Output = f64;

    fn visit<P: ContactSprings>(self, springs: P) -> f64 {
        let Self { engine, settings } = self;
        let contacts = &mut engine.contacts;
        let input = ForceInput::new(&engine.state, contacts.images.offsets(), settings, springs);
        let Some(pairs) = contacts.subdomains.first_mut() else { return 0.0 };
        let mut part = pairs.part_mut(0);
        let (chunk, with_virial) = (part.chunk(0), false);
        let rescaled = settings.tangential == TangentialLaw::Rescaled;
        OPERATIONS.set(0);
        macro_rules! frictional {
            ($sliding:literal, $rescaled:literal) => {
                ForceKernel::<Frictional<P, true, $sliding, $rescaled, false>> { input, chunk, with_virial }
                    .run::<Counted>()
            };
        }
        match (settings.features(), rescaled) {
            (Features::Frictionless, _) => {
                ForceKernel::<Frictionless<P, false>> { input, chunk, with_virial }.run::<Counted>()
            }
            (Features::Sliding, true) => frictional!(true, true),
            (Features::Sliding, false) => frictional!(true, false),
            (Features::NoSlip, true) => frictional!(false, true),
            (Features::NoSlip, false) => frictional!(false, false),
        };
        OPERATIONS.get() as f64 / BLOCK_SIZE as f64
    }
}

/// Runs independent chains of fused multiply-adds (two operations each) for `rounds`, to measure the peak rate of the
/// processor. Returns the number of operations, and a number that depends on all of them.
pub fn peak_flops(simd: Simd, rounds: u64) -> (u64, f64) {
    simd.run(Chains { rounds })
}

struct Chains {
    rounds: u64,
}

/// Independent chains: enough to hide the latency of an addition.
const CHAINS: usize = 12;

impl Kernel for Chains {
    type Output = (u64, f64);

    #[inline(always)]
    fn run<L: SimdF64>(self) -> (u64, f64) {
        let mut chains = [L::splat(1.0); CHAINS];
        // Hidden from the compiler, which would otherwise simplify the loop.
        let (factor, addend) = (L::splat(black_box(0.999_999)), L::splat(black_box(1e-6)));
        for _ in 0..self.rounds {
            for chain in &mut chains {
                *chain = chain.mul_add(factor, addend);
            }
        }
        let mut last = [0.0; BLOCK_SIZE];
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
            operations_per_contact(
                ContactLaw::default(),
                &EngineSettings { friction, damping: 0.3, ..EngineSettings::default() },
            )
        };
        assert!(of(0.0) > 30.0);
        assert!(of(f64::INFINITY) > 2.0 * of(0.0));
        assert!(of(0.3) > of(f64::INFINITY));
    }
}
