//! Positions of pairs, and the test for contact.

use crate::domain::state::State;
use crate::pairs::types::{PairBlock, PairSizes};
use crate::simd::simd_f64::{BLOCK_SIZE, CheckedIndices, F64x4, F64x8, SimdF64};
use grainlab_core::contact::{ContactSprings, SpringDashpotSlider};
use grainlab_core::effective_radius;
use grainlab_core::lanes::LaneVec3;
use grainlab_engine::EngineSettings;

#[derive(Clone, Copy)]
pub(crate) struct ForceInput<'a, S> {
    pub(crate) position: &'a [F64x4],
    pub(crate) twist: &'a [F64x8],
    /// Offset of each periodic image, m.
    pub(crate) offset: &'a [F64x4],
    /// Columns of the strain rate, 1/s.
    pub(crate) rate: [[f64; 3]; 3],
    pub(crate) law: SpringDashpotSlider<S>,
    pub(crate) dt: f64,
    pub(crate) common: CommonSize,
}

impl<'a, S: ContactSprings> ForceInput<'a, S> {
    pub(crate) fn new(state: &'a State, offset: &'a [F64x4], settings: &EngineSettings, springs: S) -> Self {
        let radius = state.largest_radius;
        let m_eff = state.inverse_mass.first().map_or(0.0, |inverse| 1.0 / (inverse + inverse));
        Self {
            position: &state.position,
            twist: &state.twist,
            offset,
            rate: state.rate.into(),
            law: settings.law(springs),
            dt: state.time_step,
            common: CommonSize { radius, r_eff: effective_radius(radius, radius), m_eff },
        }
    }
}

/// The size of every pair, where grains are of one size.
#[derive(Clone, Copy)]
pub(crate) struct CommonSize {
    pub(crate) radius: f64,
    pub(crate) r_eff: f64,
    pub(crate) m_eff: f64,
}

/// Radii, R* and effective mass of some lanes of a block; `sizes` where grains differ in size.
#[inline(always)]
pub(crate) fn sizes_of<P, L: SimdF64>(
    input: &ForceInput<'_, P>,
    sizes: Option<&PairSizes>,
    lane: usize,
) -> ([L; 2], L, L) {
    match sizes {
        Some(s) => {
            let radius = [L::load(&s.radius_i, lane), L::load(&s.radius_j, lane)];
            (radius, L::load(&s.r_eff, lane), L::load(&s.m_eff, lane))
        }
        None => {
            let c = &input.common;
            ([L::splat(c.radius); 2], L::splat(c.r_eff), L::splat(c.m_eff))
        }
    }
}

#[derive(Clone, Copy)]
pub(crate) struct GrainIndices<'a, L> {
    pub(crate) i: CheckedIndices<'a, L>,
    pub(crate) j: CheckedIndices<'a, L>,
}

impl<'a, L: SimdF64> GrainIndices<'a, L> {
    #[inline(always)]
    pub(crate) fn new<S>(
        input: &ForceInput<'_, S>,
        i: &'a [u32; BLOCK_SIZE],
        j: &'a [u32; BLOCK_SIZE],
        lane: usize,
    ) -> Self {
        let grains = input.position.len();
        Self { i: CheckedIndices::new(i, lane, grains), j: CheckedIndices::new(j, lane, grains) }
    }
}

pub(crate) struct Geometry<L: SimdF64> {
    pub(crate) radius: [L; 2],
    pub(crate) branch: LaneVec3<L>,
    pub(crate) normal: LaneVec3<L>,
    pub(crate) distance: L,
    pub(crate) inverse_distance: L,
    /// Overlap, never negative, m.
    pub(crate) overlap: L,
    pub(crate) touching: L::Mask,
}

impl<L: SimdF64> Geometry<L> {
    /// `None` where no lane touches.
    #[inline(always)]
    pub(crate) fn new<S>(
        input: &ForceInput<'_, S>,
        block: &PairBlock,
        sizes: Option<&PairSizes>,
        lane: usize,
    ) -> Option<Self> {
        let grains = GrainIndices::new(input, &block.i, &block.j, lane);
        let image = CheckedIndices::new(&block.image, lane, input.offset.len());
        let (radius, ..) = sizes_of::<S, L>(input, sizes, lane);
        let difference = L::gather_difference(input.position, grains.j, grains.i);
        let branch = difference + L::gather(input.offset, image);
        let reach = radius[0] + radius[1];
        let square = branch.dot(branch);
        if !L::any((reach * reach).gt(square)) {
            return None;
        }
        let distance = square.sqrt();
        // Not 1/distance: so the root and the division need not wait for each other.
        let inverse_distance = distance * (L::splat(1.0) / square);
        let overlap = (reach - distance).max(L::splat(0.0));
        Some(Self {
            radius,
            branch,
            normal: branch.scale(inverse_distance),
            distance,
            inverse_distance,
            overlap,
            touching: overlap.gt(L::splat(0.0)),
        })
    }
}
