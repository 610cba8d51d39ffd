//! The stress along the way, from what acts on grains.
//!
//! Love–Weber, Σ_c f ⊗ l with l the branch vector x_j − x_i + s, is Σ_i F_i ⊗ x_i over grains plus Σ_c f ⊗ s over the
//! contacts across the faces of the cell (Thompson, Plimpton & Mattson, J. Chem. Phys. 131, 154107 (2009), Eq. 21): far
//! fewer terms, and none that has to be summed across lanes.

use crate::lanes::{BLOCK, Lanes, Quad, Row};
use crate::share::Crossing;
use crate::simd::{Kernel, Simd};
use crate::sums::Act;
use grainlab_core::{Mat3, SymTensor};

/// Σ f ⊗ l so far, J: three rows, one for each component of the force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Seen {
    virial: [Quad; 3],
}

impl Seen {
    /// This, then what was seen next.
    #[inline(always)]
    pub(crate) fn then(&mut self, next: &Self) {
        for (row, next) in self.virial.iter_mut().zip(next.virial) {
            row.iter_mut().zip(next).for_each(|(sum, next)| *sum += next);
        }
    }

    /// Adds f ⊗ l.
    #[inline(always)]
    fn add(&mut self, f: [f64; 3], l: &Quad) {
        for (row, f) in self.virial.iter_mut().zip(f) {
            for (sum, l) in row.iter_mut().zip(l) {
                *sum = f.mul_add(*l, *sum);
            }
        }
    }

    /// The stress in a cell of `volume` (m³), Pa, positive in compression.
    pub(crate) fn stress(&self, volume: f64) -> SymTensor {
        SymTensor::symmetric_part(&(Mat3::from_fn(|k, c| self.virial[k][c]) / volume))
    }
}

/// Adds what pairs of block `b` do across the faces, with `force` on their second grains. Returns what is left of
/// `crossing`.
#[inline(always)]
pub(crate) fn cross<'a>(
    seen: &mut Seen,
    mut crossing: &'a [Crossing],
    b: usize,
    shift: &[Quad],
    force: &[[f64; BLOCK]; 3],
) -> &'a [Crossing] {
    while let Some((c, rest)) = crossing.split_first()
        && c.slot as usize / BLOCK == b
    {
        let lane = c.slot as usize % BLOCK;
        seen.add([force[0][lane], force[1][lane], force[2][lane]], &shift[c.image as usize]);
        crossing = rest;
    }
    crossing
}

/// Σ F ⊗ x over the grains of a chunk.
pub(crate) fn inner<A: Act>(acts: A, position: &[Quad], simd: Simd) -> Seen {
    simd.run(Inner { acts, position })
}

struct Inner<'a, A> {
    acts: A,
    position: &'a [Quad],
}

impl<A: Act> Kernel for Inner<'_, A> {
    type Output = Seen;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Seen {
        let mut acts = self.acts;
        let mut virial = [L::Row::splat(0.0); 3];
        for (k, x) in self.position.iter().enumerate() {
            let [force, _] = acts.on::<L::Row>(k);
            let (mut f, x) = ([0.0; 4], L::Row::load(x, 0));
            force.store(&mut f, 0);
            for (sum, f) in virial.iter_mut().zip(f) {
                *sum = L::Row::splat(f).mul_add(x, *sum);
            }
        }
        let mut seen = Seen::default();
        for (row, sum) in seen.virial.iter_mut().zip(virial) {
            sum.store(row, 0);
        }
        seen
    }
}
