//! The force kernel: forces and torques of the pairs of a chunk of grains, summed on the grains.
//!
//! It has three stages: geometry, contact law, scatter. Each stage waits long for the roots, quotients and sums of the one
//! before. So the stages of three consecutive blocks run interleaved, and the processor always has independent work.

use super::geometry::{ForceInput, Geometry, GrainIndices};
use super::virial::{self, Virial};
use crate::pairs::types::{PairBlock, PairChunk, PairSizes};
use crate::simd::kernel::Kernel;
use crate::simd::simd_f64::{BLOCK_SIZE, CheckedIndices, F64x8, SimdF64, load_vector, store_vector};
use grainlab_core::contact::{ContactKinematics, ContactSprings};
use grainlab_core::lanes::{LaneVec3, Lanes};

/// Packings with more grains than this prefetch the rows of second grains: smaller ones stay in the cache.
const PREFETCH_MIN_GRAINS: usize = 8000;

/// Blocks ahead of the present one that are prefetched.
const PREFETCH_DISTANCE: usize = 6;

/// Contacts without friction: no spins, no tangential springs.
pub(crate) struct FrictionlessKernel<'a, P, const SIZES: bool> {
    pub(crate) input: ForceInput<'a, P>,
    pub(crate) chunk: PairChunk<'a>,
    /// Whether to sum the virial of periodic pairs.
    pub(crate) with_virial: bool,
}

/// Contacts with friction; see [`full_force`](grainlab_core::contact::SpringDashpotSlider::full_force) for the switches.
/// `SIZES`: grains differ in size.
pub(crate) struct FrictionalKernel<
    'a,
    P,
    const ADVANCE: bool,
    const SLIDING: bool,
    const RESCALED: bool,
    const SIZES: bool,
> {
    pub(crate) input: ForceInput<'a, P>,
    pub(crate) chunk: PairChunk<'a>,
    /// Whether to sum the virial of periodic pairs.
    pub(crate) with_virial: bool,
}

type BlockScalars = [f64; BLOCK_SIZE];
type BlockVectors = [BlockScalars; 3];

/// Intermediate results of a block between stages.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct BlockScratch {
    normal: BlockVectors,
    overlap: BlockScalars,
    inverse_distance: BlockScalars,
    /// On the second grain of each pair, N.
    force: BlockVectors,
    /// On both grains, N m. Where sizes differ it is still to be multiplied by the levers of the second and the first grain.
    moment: BlockVectors,
    levers: [BlockScalars; 2],
}

impl BlockScratch {
    const ZERO: Self = {
        let zero = [0.0; BLOCK_SIZE];
        Self {
            normal: [zero; 3],
            overlap: zero,
            inverse_distance: zero,
            force: [zero; 3],
            moment: [zero; 3],
            levers: [zero; 2],
        }
    };
}

/// The law stage of a phase.
trait LawStage {
    /// Whether contacts exert moments.
    const MOMENTS: bool;
    /// Whether grains differ in size.
    const SIZES: bool;
    /// The springs of the contact law.
    type Springs: ContactSprings;

    /// Second stage: forces of some lanes of a block.
    fn law<L: SimdF64>(
        input: &ForceInput<'_, Self::Springs>,
        block: &mut PairBlock,
        sizes: Option<&PairSizes>,
        scratch: &mut BlockScratch,
        lane: usize,
    );
}

/// All pairs of a chunk.
#[inline(always)]
fn run_stages<S: LawStage, L: SimdF64>(
    input: &ForceInput<'_, S::Springs>,
    chunk: PairChunk<'_>,
    with_virial: bool,
) -> Virial {
    let PairChunk { blocks, sizes, mut periodic, sums } = chunk;
    let mut virial = Virial::default();
    let prefetch = input.position.len() > PREFETCH_MIN_GRAINS;
    let units_per_block = BLOCK_SIZE / L::WIDTH;
    let end = blocks.len() * units_per_block;
    // A unit is as many pairs as lanes. Units pass the stages one after the other; two blocks are in work at a time.
    let mut scratch = [BlockScratch::ZERO; 2];
    let (mut has_forces, mut touches) =
        (false, end > 0 && geometry::<S, L>(input, blocks, sizes, &mut scratch, 0));
    for u in 0..=end {
        let (touched, before) = (touches, has_forces);
        let (b, lane) = (u / units_per_block, u % units_per_block * L::WIDTH);
        if touched {
            S::law::<L>(input, &mut blocks[b], sizes.get(b), &mut scratch[b % 2], lane);
        } else if with_virial {
            store_vector(LaneVec3::<L>::splat(0.0), &mut scratch[b % 2].force, lane);
        }
        touches = u + 1 < end && geometry::<S, L>(input, blocks, sizes, &mut scratch, u + 1);
        if before {
            let (b, lane) = ((u - 1) / units_per_block, (u - 1) % units_per_block * L::WIDTH);
            scatter::<S, L>(input.position.len(), &blocks[b], &scratch[b % 2], lane, sums);
        }
        has_forces = touched;
        if u > 0 && u % units_per_block == 0 {
            let b = u / units_per_block - 1;
            if with_virial {
                let force = &scratch[b % 2].force;
                periodic = virial::add_periodic(&mut virial, periodic, b, input.offset, force);
            }
            if prefetch && let Some(ahead) = blocks.get(b + PREFETCH_DISTANCE) {
                L::prefetch(input.position, &ahead.j);
                L::prefetch(input.twist, &ahead.j);
                L::prefetch(sums, &ahead.accumulator_row);
            }
        }
    }
    virial
}

/// First stage: geometry of the pairs of unit `u`. Returns whether any touch. If none does, their history is cleared.
#[inline(always)]
fn geometry<S: LawStage, L: SimdF64>(
    input: &ForceInput<'_, S::Springs>,
    blocks: &mut [PairBlock],
    sizes: &[PairSizes],
    scratch: &mut [BlockScratch; 2],
    u: usize,
) -> bool {
    let units_per_block = BLOCK_SIZE / L::WIDTH;
    let (b, lane) = (u / units_per_block, u % units_per_block * L::WIDTH);
    let (block, scratch) = (&mut blocks[b], &mut scratch[b % 2]);
    let geometry = if S::SIZES {
        Geometry::<L>::new::<_, true>(input, block, sizes.get(b), lane)
    } else {
        Geometry::<L>::new::<_, false>(input, block, None, lane)
    };
    match geometry {
        Some(g) => {
            store_vector(g.normal, &mut scratch.normal, lane);
            g.overlap.store(&mut scratch.overlap, lane);
            g.inverse_distance.store(&mut scratch.inverse_distance, lane);
            true
        }
        None => {
            let zero = LaneVec3::<L>::splat(0.0);
            zero.x.store(&mut block.contact_radius, lane);
            store_vector(zero, &mut block.history, lane);
            false
        }
    }
}

/// Last stage: adds forces and moments to the sums of grains.
#[inline(always)]
fn scatter<S: LawStage, L: SimdF64>(
    grains: usize,
    block: &PairBlock,
    scratch: &BlockScratch,
    lane: usize,
    sums: &mut [F64x8],
) {
    let (rows, zero) = (sums.len(), L::splat(0.0));
    let to = CheckedIndices::<L>::new(&block.accumulator_row, lane, rows);
    let from = CheckedIndices::<L>::new(&block.i, lane, grains);
    let f = load_vector::<L>(&scratch.force, lane);
    let m = if S::MOMENTS { load_vector::<L>(&scratch.moment, lane) } else { LaneVec3::splat(0.0) };
    let mut levers = [zero; 2];
    if S::SIZES && S::MOMENTS {
        levers = [L::load(&scratch.levers[0], lane), L::load(&scratch.levers[1], lane)];
    }
    let components = [f.x, f.y, f.z, levers[0], m.x, m.y, m.z, levers[1]];
    match (S::MOMENTS, S::SIZES) {
        (false, _) => L::scatter_add::<false, false>(components, from, to, sums),
        (true, false) => L::scatter_add::<true, false>(components, from, to, sums),
        (true, true) => L::scatter_add::<true, true>(components, from, to, sums),
    }
}

/// Radii, R* and effective mass of some lanes of a block.
#[inline(always)]
fn sizes_of<P, L: SimdF64, const SIZES: bool>(
    input: &ForceInput<'_, P>,
    sizes: Option<&PairSizes>,
    lane: usize,
) -> ([L; 2], L, L) {
    match sizes {
        Some(s) if SIZES => {
            let radius = [L::load(&s.radius_i, lane), L::load(&s.radius_j, lane)];
            (radius, L::load(&s.r_eff, lane), L::load(&s.m_eff, lane))
        }
        _ => {
            let c = &input.common;
            ([L::splat(c.radius); 2], L::splat(c.r_eff), L::splat(c.m_eff))
        }
    }
}

/// Relative velocity of the ends of a branch vector that follow the affine motion, m/s.
#[inline(always)]
fn affine_velocity<P, L: Lanes>(input: &ForceInput<'_, P>, l: LaneVec3<L>) -> LaneVec3<L> {
    let [x, y, z] = &input.rate;
    LaneVec3::splat_vector(x)
        .scale(l.x)
        .add_scaled(LaneVec3::splat_vector(y), l.y)
        .add_scaled(LaneVec3::splat_vector(z), l.z)
}

impl<P: ContactSprings, const SIZES: bool> LawStage for FrictionlessKernel<'_, P, SIZES> {
    const MOMENTS: bool = false;
    const SIZES: bool = SIZES;
    type Springs = P;

    #[inline(always)]
    fn law<L: SimdF64>(
        input: &ForceInput<'_, P>,
        block: &mut PairBlock,
        sizes: Option<&PairSizes>,
        scratch: &mut BlockScratch,
        lane: usize,
    ) {
        let (radius, r_eff, m_eff) = sizes_of::<P, L, SIZES>(input, sizes, lane);
        let grains = GrainIndices::<L>::new(input, &block.i, &block.j, lane);
        let (normal, overlap) = (load_vector::<L>(&scratch.normal, lane), L::load(&scratch.overlap, lane));
        let contact_radius = (r_eff * overlap).sqrt();
        let distance = radius[0] + radius[1] - overlap;
        let [velocity, _] = L::gather_relative_motion(input.twist, grains.j, grains.i);
        let relative_velocity = velocity + affine_velocity(input, normal.scale(distance));
        let separation_speed = relative_velocity.dot(normal);
        let force = input.law.normal_force(overlap, contact_radius, m_eff, separation_speed);
        contact_radius.store(&mut block.contact_radius, lane);
        let touching = overlap.gt(L::splat(0.0));
        let force = LaneVec3::select(touching, normal.scale(force), LaneVec3::splat(0.0));
        store_vector(force, &mut scratch.force, lane);
    }
}

impl<P: ContactSprings, const SIZES: bool> Kernel for FrictionlessKernel<'_, P, SIZES> {
    type Output = Virial;

    #[inline(always)]
    fn run<L: SimdF64>(self) -> Virial {
        run_stages::<Self, L>(&self.input, self.chunk, self.with_virial)
    }
}

impl<P: ContactSprings, const ADVANCE: bool, const SLIDING: bool, const RESCALED: bool, const SIZES: bool>
    LawStage for FrictionalKernel<'_, P, ADVANCE, SLIDING, RESCALED, SIZES>
{
    const MOMENTS: bool = true;
    const SIZES: bool = SIZES;
    type Springs = P;

    #[inline(always)]
    fn law<L: SimdF64>(
        input: &ForceInput<'_, P>,
        block: &mut PairBlock,
        sizes: Option<&PairSizes>,
        scratch: &mut BlockScratch,
        lane: usize,
    ) {
        let (half, zero) = (L::splat(0.5), LaneVec3::splat(0.0));
        let (radius, r_eff, m_eff) = sizes_of::<P, L, SIZES>(input, sizes, lane);
        let (normal, overlap) = (load_vector::<L>(&scratch.normal, lane), L::load(&scratch.overlap, lane));
        let (contact_radius, before) = ((r_eff * overlap).sqrt(), L::load(&block.contact_radius, lane));
        let lever = [half.neg_mul_add(overlap, radius[0]), half.neg_mul_add(overlap, radius[1])];
        let grains = GrainIndices::<L>::new(input, &block.i, &block.j, lane);
        let [velocity, spin_sum] = L::gather_relative_motion(input.twist, grains.j, grains.i);
        let spin_velocity = if SIZES {
            let spins = [L::gather_spins(input.twist, grains.i), L::gather_spins(input.twist, grains.j)];
            spins[0].scale(lever[0]) + spins[1].scale(lever[1])
        } else {
            spin_sum.scale(lever[0])
        };
        let distance = radius[0] + radius[1] - overlap;
        let kinematics = ContactKinematics {
            normal,
            inverse_distance: L::load(&scratch.inverse_distance, lane),
            overlap,
            contact_radius,
            contact_radius_before: before,
            m_eff,
            relative_velocity: velocity + affine_velocity(input, normal.scale(distance)),
            spin_velocity,
            spin_sum,
        };
        let history = load_vector(&block.history, lane);
        let forces = input.law.full_force::<L, ADVANCE, SLIDING, RESCALED>(&kinematics, history, input.dt);
        let touching = overlap.gt(L::splat(0.0));
        contact_radius.store(&mut block.contact_radius, lane);
        if ADVANCE {
            store_vector(LaneVec3::select(touching, forces.history, zero), &mut block.history, lane);
        }
        let force = normal.scale_sub(forces.normal, forces.tangential);
        store_vector(LaneVec3::select(touching, force, zero), &mut scratch.force, lane);
        let moment = LaneVec3::select(touching, normal.cross(forces.tangential), zero);
        // With one size there is one lever, which is applied here. Else each grain applies its own.
        if SIZES {
            store_vector(moment, &mut scratch.moment, lane);
            lever[1].store(&mut scratch.levers[0], lane);
            lever[0].store(&mut scratch.levers[1], lane);
        } else {
            store_vector(moment.scale(lever[0]), &mut scratch.moment, lane);
        }
    }
}

impl<P: ContactSprings, const ADVANCE: bool, const SLIDING: bool, const RESCALED: bool, const SIZES: bool>
    Kernel for FrictionalKernel<'_, P, ADVANCE, SLIDING, RESCALED, SIZES>
{
    type Output = Virial;

    #[inline(always)]
    fn run<L: SimdF64>(self) -> Virial {
        run_stages::<Self, L>(&self.input, self.chunk, self.with_virial)
    }
}
