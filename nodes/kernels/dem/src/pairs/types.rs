//! Pairs of grains as they are stored: eight to a block.

use crate::simd::simd_f64::{BLOCK_SIZE, F64x8};
use grainlab_core::{Vec3, effective_radius};

/// Row in the table of periodic images of the pairs that only pad a block. It is so far away that they never touch.
pub(crate) const PADDING: u32 = 0;

#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct PairBlock {
    /// Contact radius √(R* δ) at the last evaluation, m; 0 where the pair does not touch.
    pub(crate) contact_radius: [f64; BLOCK_SIZE],
    /// Elastic tangential force on `i`, N: the history of the contact.
    pub(crate) history: [[f64; BLOCK_SIZE]; 3],
    pub(crate) i: [u32; BLOCK_SIZE],
    pub(crate) j: [u32; BLOCK_SIZE],
    /// Row in the table of periodic images.
    pub(crate) image: [u32; BLOCK_SIZE],
    /// Row of the accumulator for the force on `j`. The row for `i` is its index in the chunk.
    pub(crate) accumulator_row: [u32; BLOCK_SIZE],
}

/// Elastic rolling forces of eight pairs, N; stored only where contacts resist rolling.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(crate) struct RollingBlock {
    pub(crate) history: [[f64; BLOCK_SIZE]; 3],
}

/// Sizes of eight pairs; stored only where grains differ in size.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct PairSizes {
    pub(crate) radius_i: [f64; BLOCK_SIZE],
    pub(crate) radius_j: [f64; BLOCK_SIZE],
    pub(crate) r_eff: [f64; BLOCK_SIZE],
    pub(crate) m_eff: [f64; BLOCK_SIZE],
}

/// A pair whose second grain is a periodic image.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PeriodicPair {
    /// Slot of the pair among those of its chunk.
    pub(crate) slot: u32,
    /// Row in the table of periodic images.
    pub(crate) image: u32,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    pub(crate) i: u32,
    pub(crate) j: u32,
    /// Row in the table of periodic images.
    pub(crate) image: u32,
    pub(crate) history: History,
}

/// State of a contact that the steps before left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct History {
    /// Contact radius √(R* δ), m; 0 where the pair does not touch.
    pub(crate) contact_radius: f64,
    /// Elastic tangential force on `i`, N.
    pub(crate) tangential: Vec3,
    /// Elastic rolling force, N: its torque on `i` is R* n × it. Zero without resistance to rolling.
    pub(crate) rolling: Vec3,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct SavedContact {
    pub(crate) i: u32,
    pub(crate) j: u32,
    pub(crate) image: [i8; 3],
    pub(crate) history: History,
}

pub(crate) struct PairChunk<'a> {
    pub(crate) blocks: &'a mut [PairBlock],
    /// Empty where contacts do not resist rolling.
    pub(crate) rolling: &'a mut [RollingBlock],
    /// Empty where grains are of one size.
    pub(crate) sizes: &'a [PairSizes],
    pub(crate) periodic: &'a [PeriodicPair],
    /// Accumulator rows, those of the chunk's grains first.
    pub(crate) sums: &'a mut [F64x8],
}

impl Pair {
    pub(crate) fn touches(&self) -> bool {
        self.history.contact_radius > 0.0
    }

    /// Full overlap with this contact radius (m), m, of grains of these radii (m).
    pub(crate) fn overlap(&self, radii: &[f64], contact_radius: f64) -> f64 {
        contact_radius * contact_radius / effective_radius(radii[self.i as usize], radii[self.j as usize])
    }
}

impl PairBlock {
    #[inline(always)]
    pub(crate) fn history(&self, rolling: Option<&RollingBlock>, lane: usize) -> History {
        let vector = |h: &[[f64; BLOCK_SIZE]; 3]| Vec3::new(h[0][lane], h[1][lane], h[2][lane]);
        History {
            contact_radius: self.contact_radius[lane],
            tangential: vector(&self.history),
            rolling: rolling.map_or_else(Vec3::zeros, |r| vector(&r.history)),
        }
    }

    /// The pair in a lane; `None` where it only pads the block.
    #[inline(always)]
    pub(crate) fn pair(&self, rolling: Option<&RollingBlock>, lane: usize) -> Option<Pair> {
        (self.image[lane] != PADDING).then(|| Pair {
            i: self.i[lane],
            j: self.j[lane],
            image: self.image[lane],
            history: self.history(rolling, lane),
        })
    }
}
