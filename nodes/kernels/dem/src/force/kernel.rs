//! The force kernel: forces and torques of the pairs of a chunk of grains, summed on the grains.

use super::geometry::{ForceInput, GrainIndices, sizes_of};
use super::stages::{BlockScratch, LawStage, Rolling, run_stages};
use super::virial::Virial;
use crate::pairs::types::{PairBlock, PairChunk, PairSizes};
use crate::simd::instruction_set::Simd;
use crate::simd::kernel::Kernel;
use crate::simd::simd_f64::{SimdF64, load_vector, store_vector};
use grainlab_core::contact::{ContactKinematics, ContactSprings};
use grainlab_core::lanes::{LaneVec3, Lanes};
use std::marker::PhantomData;

/// Contacts without friction: no spins, no tangential springs.
pub(crate) struct Frictionless<P, const SIZES: bool>(PhantomData<P>);

/// Contacts with friction; see [`full_force`](grainlab_core::contact::SpringDashpotSlider::full_force) for the switches.
/// `SIZES`: grains differ in size.
pub(crate) struct Frictional<P, const ADVANCE: bool, const SLIDING: bool, const SIZES: bool>(PhantomData<P>);

/// Forces of the pairs of a chunk, added to its sums. Returns the virial of periodic pairs, if it is asked for.
pub(crate) fn forces<S: LawStage>(
    simd: Simd,
    input: ForceInput<'_, S::Springs>,
    chunk: PairChunk<'_>,
    with_virial: bool,
) -> Virial {
    simd.run(ForceKernel::<S> { input, chunk, with_virial })
}

/// As [`forces`], with one lane, which gives the same bits: for a pass that is made once, at a resume.
pub(crate) fn forces_once<S: LawStage>(
    _: Simd,
    input: ForceInput<'_, S::Springs>,
    chunk: PairChunk<'_>,
    with_virial: bool,
) -> Virial {
    ForceKernel::<S> { input, chunk, with_virial }.run::<f64>()
}

pub(crate) struct ForceKernel<'a, S: LawStage> {
    pub(crate) input: ForceInput<'a, S::Springs>,
    pub(crate) chunk: PairChunk<'a>,
    pub(crate) with_virial: bool,
}

impl<S: LawStage> Kernel for ForceKernel<'_, S> {
    type Output = Virial;

    #[inline(always)]
    fn run<L: SimdF64>(self) -> Virial {
        run_stages::<S, L>(&self.input, self.chunk, self.with_virial)
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

/// Some lanes of a block as the contact law needs them.
struct LaneContact<'a, L: SimdF64> {
    grains: GrainIndices<'a, L>,
    radius: [L; 2],
    r_eff: L,
    m_eff: L,
    normal: LaneVec3<L>,
    overlap: L,
    contact_radius: L,
    /// Affine part included, m/s.
    relative_velocity: LaneVec3<L>,
    /// Sum of both spins, rad/s.
    spin_sum: LaneVec3<L>,
}

impl<'a, L: SimdF64> LaneContact<'a, L> {
    #[inline(always)]
    fn new<P>(
        input: &ForceInput<'_, P>,
        block: &'a PairBlock,
        sizes: Option<&PairSizes>,
        scratch: &BlockScratch,
        lane: usize,
    ) -> Self {
        let (radius, r_eff, m_eff) = sizes_of::<P, L>(input, sizes, lane);
        let (normal, overlap) = (load_vector::<L>(&scratch.normal, lane), L::load(&scratch.overlap, lane));
        let grains = GrainIndices::<L>::new(input, &block.i, &block.j, lane);
        let distance = radius[0] + radius[1] - overlap;
        let [velocity, spin_sum] = L::gather_relative_motion(input.twist, grains.j, grains.i);
        Self {
            grains,
            radius,
            r_eff,
            m_eff,
            normal,
            overlap,
            contact_radius: (r_eff * overlap).sqrt(),
            relative_velocity: velocity + affine_velocity(input, normal.scale(distance)),
            spin_sum,
        }
    }
}

impl<P: ContactSprings, const SIZES: bool> LawStage for Frictionless<P, SIZES> {
    const MOMENTS: bool = false;
    const SIZES: bool = SIZES;
    type Springs = P;

    #[inline(always)]
    fn law<L: SimdF64>(
        input: &ForceInput<'_, P>,
        block: &mut PairBlock,
        _: Option<Rolling<'_>>,
        sizes: Option<&PairSizes>,
        scratch: &mut BlockScratch,
        lane: usize,
    ) {
        let c = LaneContact::<L>::new(input, block, sizes, scratch, lane);
        let separation_speed = c.relative_velocity.dot(c.normal);
        let force = input.law.normal_force(c.overlap, c.contact_radius, c.m_eff, separation_speed);
        let touching = c.overlap.gt(L::splat(0.0));
        let force = LaneVec3::select(touching, c.normal.scale(force), LaneVec3::splat(0.0));
        c.contact_radius.store(&mut block.contact_radius, lane);
        store_vector(force, &mut scratch.force, lane);
    }
}

impl<P: ContactSprings, const ADVANCE: bool, const SLIDING: bool, const SIZES: bool> LawStage
    for Frictional<P, ADVANCE, SLIDING, SIZES>
{
    const MOMENTS: bool = true;
    const SIZES: bool = SIZES;
    type Springs = P;

    #[inline(always)]
    fn law<L: SimdF64>(
        input: &ForceInput<'_, P>,
        block: &mut PairBlock,
        rolling: Option<Rolling<'_>>,
        sizes: Option<&PairSizes>,
        scratch: &mut BlockScratch,
        lane: usize,
    ) {
        let (half, zero) = (L::splat(0.5), LaneVec3::splat(0.0));
        let c = LaneContact::<L>::new(input, block, sizes, scratch, lane);
        let (grains, normal, contact_radius) = (c.grains, c.normal, c.contact_radius);
        let lever = [half.neg_mul_add(c.overlap, c.radius[0]), half.neg_mul_add(c.overlap, c.radius[1])];
        let spins = || [L::gather_spins(input.twist, grains.i), L::gather_spins(input.twist, grains.j)];
        let spin_velocity = if SIZES {
            let spins = spins();
            spins[0].scale(lever[0]) + spins[1].scale(lever[1])
        } else {
            c.spin_sum.scale(lever[0])
        };
        let kinematics = ContactKinematics {
            normal,
            inverse_distance: L::load(&scratch.inverse_distance, lane),
            overlap: c.overlap,
            contact_radius,
            contact_radius_before: L::load(&block.contact_radius, lane),
            m_eff: c.m_eff,
            relative_velocity: c.relative_velocity,
            spin_velocity,
            spin_sum: c.spin_sum,
        };
        let history = load_vector(&block.history, lane);
        let forces = input.law.full_force::<L, ADVANCE, SLIDING>(&kinematics, history, input.dt);
        let touching = c.overlap.gt(L::splat(0.0));
        if P::ROLLS
            && let Some((block, rolling_moment)) = rolling
        {
            let [first, second] = spins();
            let velocity = (second - first).cross(normal).scale(c.r_eff);
            let history = load_vector(&block.history, lane);
            let force = input.law.rolling_force::<L, ADVANCE>(
                &kinematics,
                velocity,
                forces.elastic,
                history,
                input.dt,
            );
            if ADVANCE {
                store_vector(LaneVec3::select(touching, force.history, zero), &mut block.history, lane);
            }
            let moment = LaneVec3::select(touching, normal.cross(force.total).scale(c.r_eff), zero);
            store_vector(moment, rolling_moment, lane);
        }
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
