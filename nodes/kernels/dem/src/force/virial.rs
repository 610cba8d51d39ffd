//! The stress of a step, from the forces on grains.
//!
//! Love–Weber, Σ_c f ⊗ l with l the branch vector x_j − x_i + s, equals Σ_i F_i ⊗ x_i over grains plus Σ_c f ⊗ s over the
//! contacts across the faces of the cell (Thompson, Plimpton & Mattson, J. Chem. Phys. 131, 154107 (2009), Eq. 21). That has
//! far fewer terms, and needs no sum across lanes.

use crate::domain::accumulator::ChunkForces;
use crate::pairs::types::PeriodicPair;
use crate::simd::instruction_set::Simd;
use crate::simd::kernel::Kernel;
use crate::simd::simd_f64::{BLOCK_SIZE, F64x4, SimdF64, SimdRow};
use grainlab_core::{Mat3, SymTensor};

/// Σ f ⊗ l, J: three rows, one per component of the force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Virial {
    rows: [F64x4; 3],
}

impl Virial {
    /// Adds another virial, after this one in the order of the sum.
    #[inline(always)]
    pub(crate) fn add(&mut self, next: &Self) {
        for (row, next) in self.rows.iter_mut().zip(next.rows) {
            row.iter_mut().zip(next).for_each(|(sum, next)| *sum += next);
        }
    }

    #[inline(always)]
    fn add_dyad(&mut self, f: [f64; 3], l: &F64x4) {
        for (row, f) in self.rows.iter_mut().zip(f) {
            for (sum, l) in row.iter_mut().zip(l) {
                *sum = f.mul_add(*l, *sum);
            }
        }
    }

    /// The stress in a cell of `volume` (m³), Pa, positive in compression.
    pub(crate) fn stress(&self, volume: f64) -> SymTensor {
        SymTensor::symmetric_part(&(Mat3::from_fn(|k, c| self.rows[k][c]) / volume))
    }
}

/// Adds the virial of the periodic pairs of block `b`, with `force` on their second grains. Returns the periodic pairs of
/// later blocks.
#[inline(always)]
pub(crate) fn add_periodic<'a>(
    virial: &mut Virial,
    mut periodic: &'a [PeriodicPair],
    b: usize,
    offset: &[F64x4],
    force: &[[f64; BLOCK_SIZE]; 3],
) -> &'a [PeriodicPair] {
    while let Some((pair, rest)) = periodic.split_first()
        && pair.slot as usize / BLOCK_SIZE == b
    {
        let lane = pair.slot as usize % BLOCK_SIZE;
        virial.add_dyad([force[0][lane], force[1][lane], force[2][lane]], &offset[pair.image as usize]);
        periodic = rest;
    }
    periodic
}

/// Σ F ⊗ x over the grains of a chunk.
pub(crate) fn of_chunk<F: ChunkForces>(forces: F, position: &[F64x4], simd: Simd) -> Virial {
    simd.run(ChunkVirial { forces, position })
}

struct ChunkVirial<'a, F> {
    forces: F,
    position: &'a [F64x4],
}

impl<F: ChunkForces> Kernel for ChunkVirial<'_, F> {
    type Output = Virial;

    #[inline(always)]
    fn run<L: SimdF64>(self) -> Virial {
        let mut forces = self.forces;
        let mut rows = [L::Row::splat(0.0); 3];
        for (k, x) in self.position.iter().enumerate() {
            let [force, _] = forces.on::<L::Row>(k);
            let (mut f, x) = ([0.0; 4], L::Row::load(x, 0));
            force.store(&mut f, 0);
            for (sum, f) in rows.iter_mut().zip(f) {
                *sum = L::Row::splat(f).mul_add(x, *sum);
            }
        }
        let mut virial = Virial::default();
        for (row, sum) in virial.rows.iter_mut().zip(rows) {
            sum.store(row, 0);
        }
        virial
    }
}
