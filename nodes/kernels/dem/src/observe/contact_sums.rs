//! Sums over the contacts of a chunk: stress, mean force and tangent stiffness.

use crate::force::geometry::{ForceInput, Geometry, sizes_of};
use crate::pairs::types::{PairBlock, PairSizes};
use crate::simd::instruction_set::Simd;
use crate::simd::kernel::Kernel;
use crate::simd::simd_f64::{BLOCK_SIZE, SimdF64, load_vector, store_vector};
use grainlab_core::OVERLAP_LIMIT;
use grainlab_core::contact::ContactSprings;
use grainlab_core::lanes::{LaneVec3, Lanes};

pub(super) struct ChunkContacts<'a, S> {
    pub(super) input: ForceInput<'a, S>,
    pub(super) blocks: &'a [PairBlock],
    pub(super) sizes: &'a [PairSizes],
    /// Output: the elastic force on the second grain of each slot, N.
    pub(super) force: &'a mut [SlotForces],
    pub(super) friction: bool,
}

/// Forces of the slots of one block, component by component, N.
pub(super) type SlotForces = [[f64; BLOCK_SIZE]; 3];

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ContactSums {
    /// Σ f ⊗ l (xx, yy, zz, yz, xz, xy, zy, zx, yx; J), Σ |f| (N), and the energy of each unit strain component (J).
    pub(super) values: [f64; 16],
    /// True if a contact overlaps by more than [`OVERLAP_LIMIT`].
    pub(super) too_deep: bool,
}

impl ContactSums {
    /// Adds the next chunk, in the order of the sum.
    pub(super) fn add(&mut self, next: &Self) {
        self.values.iter_mut().zip(next.values).for_each(|(a, b)| *a += b);
        self.too_deep |= next.too_deep;
    }
}

pub(super) fn sum_chunk<S: ContactSprings>(chunk: ChunkContacts<'_, S>, simd: Simd) -> ContactSums {
    if chunk.sizes.is_empty() {
        simd.run(SumKernel::<S, false> { chunk })
    } else {
        simd.run(SumKernel::<S, true> { chunk })
    }
}

struct SumKernel<'a, S, const SIZES: bool> {
    chunk: ChunkContacts<'a, S>,
}

impl<S: ContactSprings, const SIZES: bool> Kernel for SumKernel<'_, S, SIZES> {
    type Output = ContactSums;

    #[inline(always)]
    fn run<L: SimdF64>(self) -> ContactSums {
        let ChunkContacts { input, blocks, sizes, force, friction } = self.chunk;
        let (mut first, mut second) = ([0.0; 8], [0.0; 8]);
        let mut too_deep = false;
        let sizes = if SIZES { sizes } else { &[] };
        let zero = L::splat(0.0);
        for (b, block) in blocks.iter().enumerate() {
            let mut lane = 0;
            while lane < BLOCK_SIZE {
                if let Some(g) = Geometry::<L>::new(&input, block, sizes.get(b), lane) {
                    // The smaller of two is the larger of their negatives.
                    let smaller = zero - (zero - g.radius[0]).max(zero - g.radius[1]);
                    too_deep |= L::any(g.overlap.gt(smaller * L::splat(2.0 * OVERLAP_LIMIT)));
                    let (_, r_eff, _) = sizes_of::<S, L>(&input, sizes.get(b), lane);
                    let contact_radius = (r_eff * g.overlap).sqrt();
                    let k_n = input.law.springs.normal_stiffness(contact_radius, g.overlap);
                    let elastic = input.law.springs.normal_force(k_n, g.overlap);
                    let f = g.normal.scale(elastic) - load_vector(&block.history, lane);
                    let f = LaneVec3::select(g.touching, f, LaneVec3::splat(0.0));
                    store_vector(f, &mut force[b], lane);
                    let l = g.branch;
                    let size = f.dot(f).sqrt();
                    let square = L::select(g.touching, g.distance * g.distance, zero);
                    let normal = k_n * square;
                    let tangential = if friction {
                        input.law.springs.tangential_stiffness(contact_radius, g.overlap, 1.0) * square
                    } else {
                        zero
                    };
                    let t = unit_strain_energies(g.normal, normal, tangential, g.touching);
                    L::reduce_add(
                        [
                            f.x * l.x,
                            f.y * l.y,
                            f.z * l.z,
                            f.y * l.z,
                            f.x * l.z,
                            f.x * l.y,
                            f.z * l.y,
                            f.z * l.x,
                        ],
                        &mut first,
                    );
                    L::reduce_add([f.y * l.x, size, t[0], t[1], t[2], t[3], t[4], t[5]], &mut second);
                }
                lane += L::WIDTH;
            }
        }
        let mut values = [0.0; 16];
        values[..8].copy_from_slice(&first);
        values[8..].copy_from_slice(&second);
        ContactSums { values, too_deep }
    }
}

/// Energy of a contact under each unit strain component. `normal` is k_n l², `tangential` k_t l².
#[inline(always)]
fn unit_strain_energies<L: Lanes>(n: LaneVec3<L>, normal: L, tangential: L, touching: L::Mask) -> [L; 6] {
    let q = [n.x * n.x, n.y * n.y, n.z * n.z];
    let zero = L::splat(0.0);
    let mut energy = [zero; 6];
    for k in 0..3 {
        let (a, b) = (q[(k + 1) % 3], q[(k + 2) % 3]);
        let along = normal * q[k] * q[k] + tangential * (q[k] - q[k] * q[k]);
        let shear = normal * a * b + tangential * (L::splat(0.25) * (a + b) - a * b);
        energy[k] = L::select(touching, along, zero);
        energy[3 + k] = L::select(touching, shear, zero);
    }
    energy
}
