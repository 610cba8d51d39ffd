//! The stages of the force kernel: geometry, contact law, scatter.
//!
//! Each stage waits long for the roots, quotients and sums of the one before. So the stages of three consecutive units, of as
//! many pairs as lanes, run interleaved: the geometry of unit u + 1, the law of u, the scatter of u - 1. They are in at most two
//! blocks.

use super::geometry::{ForceInput, Geometry};
use super::virial::{self, Virial};
use crate::pairs::types::{PairBlock, PairChunk, PairSizes, RollingBlock};
use crate::simd::simd_f64::{BLOCK_SIZE, CheckedIndices, F64x8, SimdF64, load_vector, store_vector};
use grainlab_core::contact::ContactSprings;
use grainlab_core::lanes::LaneVec3;

/// Packings with more grains than this prefetch the rows of second grains: smaller ones stay in the cache.
const PREFETCH_MIN_GRAINS: usize = 8000;

/// Blocks ahead of the present one that are prefetched.
const PREFETCH_DISTANCE: usize = 6;

pub(super) type BlockScalars = [f64; BLOCK_SIZE];
pub(super) type BlockVectors = [BlockScalars; 3];

/// Intermediate results of a block between stages.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct BlockScratch {
    pub(super) normal: BlockVectors,
    pub(super) overlap: BlockScalars,
    pub(super) inverse_distance: BlockScalars,
    /// On the second grain of each pair, N.
    pub(super) force: BlockVectors,
    /// On both grains, N m. Where sizes differ it is still to be multiplied by the levers of the second and the first grain.
    pub(super) moment: BlockVectors,
    pub(super) levers: [BlockScalars; 2],
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

/// The rolling forces of a block, N, and the moments on the first grain of each pair that they make, N m; the opposite ones
/// are on the second grains.
pub(crate) type Rolling<'a> = (&'a mut RollingBlock, &'a mut BlockVectors);

pub(crate) trait LawStage {
    const MOMENTS: bool;
    /// True if grains differ in size.
    const SIZES: bool;
    const ROLLS: bool = Self::MOMENTS && <Self::Springs as ContactSprings>::ROLLS;
    type Springs: ContactSprings;

    /// Second stage: forces of some lanes of a block.
    fn law<L: SimdF64>(
        input: &ForceInput<'_, Self::Springs>,
        block: &mut PairBlock,
        rolling: Option<Rolling<'_>>,
        sizes: Option<&PairSizes>,
        scratch: &mut BlockScratch,
        lane: usize,
    );
}

#[inline(always)]
pub(super) fn run_stages<S: LawStage, L: SimdF64>(
    input: &ForceInput<'_, S::Springs>,
    chunk: PairChunk<'_>,
    with_virial: bool,
) -> Virial {
    let PairChunk { blocks, rolling, sizes, mut periodic, sums } = chunk;
    let sizes = if S::SIZES { sizes } else { &[] };
    let mut virial = Virial::default();
    let prefetch = input.position.len() > PREFETCH_MIN_GRAINS;
    let units_per_block = BLOCK_SIZE / L::WIDTH;
    let end = blocks.len() * units_per_block;
    let mut scratch = [BlockScratch::ZERO; 2];
    // Apart from the scratch, so that it costs nothing where no contact resists rolling.
    let mut rolling_moment = [[[0.0; BLOCK_SIZE]; 3]; 2];
    let (mut has_forces, mut touches) =
        (false, end > 0 && geometry::<S, L>(input, blocks, rolling, sizes, &mut scratch, 0));
    for u in 0..=end {
        let (touched, before) = (touches, has_forces);
        let (b, lane) = (u / units_per_block, u % units_per_block * L::WIDTH);
        if touched {
            let moment = &mut rolling_moment[b % 2];
            let rolling = if S::ROLLS { rolling.get_mut(b).map(|r| (r, moment)) } else { None };
            S::law::<L>(input, &mut blocks[b], rolling, sizes.get(b), &mut scratch[b % 2], lane);
        } else if with_virial {
            store_vector(LaneVec3::<L>::splat(0.0), &mut scratch[b % 2].force, lane);
        }
        touches = u + 1 < end && geometry::<S, L>(input, blocks, rolling, sizes, &mut scratch, u + 1);
        if before {
            let (b, lane) = ((u - 1) / units_per_block, (u - 1) % units_per_block * L::WIDTH);
            scatter::<S, L>(
                input.position.len(),
                &blocks[b],
                &scratch[b % 2],
                &rolling_moment[b % 2],
                lane,
                sums,
            );
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
    rolling: &mut [RollingBlock],
    sizes: &[PairSizes],
    scratch: &mut [BlockScratch; 2],
    u: usize,
) -> bool {
    let units_per_block = BLOCK_SIZE / L::WIDTH;
    let (b, lane) = (u / units_per_block, u % units_per_block * L::WIDTH);
    let (block, scratch) = (&mut blocks[b], &mut scratch[b % 2]);
    match Geometry::<L>::new(input, block, sizes.get(b), lane) {
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
            if S::ROLLS
                && let Some(rolling) = rolling.get_mut(b)
            {
                store_vector(zero, &mut rolling.history, lane);
            }
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
    rolling_moment: &BlockVectors,
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
    if S::ROLLS {
        let rolling = load_vector::<L>(rolling_moment, lane);
        let [second, first] = if S::SIZES { levers.map(|lever| m.scale(lever)) } else { [m; 2] };
        return L::scatter_add_each(f, [first + rolling, second - rolling], from, to, sums);
    }
    let components = [f.x, f.y, f.z, levers[0], m.x, m.y, m.z, levers[1]];
    match (S::MOMENTS, S::SIZES) {
        (false, _) => L::scatter_add::<false, false>(components, from, to, sums),
        (true, false) => L::scatter_add::<true, false>(components, from, to, sums),
        (true, true) => L::scatter_add::<true, true>(components, from, to, sums),
    }
}
