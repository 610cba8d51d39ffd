//! Lanes that load from, gather from and add to the engine's tables.

use grainlab_core::lanes::{LaneVec3, Lanes};
use std::marker::PhantomData;

/// Pairs per block.
pub(crate) const BLOCK_SIZE: usize = 8;

/// Grains per chunk: the unit of work of a thread, and of every sum over contacts.
pub(crate) const CHUNK_SIZE: usize = 256;

/// A row of a table of vectors: x, y, z and padding.
pub(crate) type F64x4 = [f64; 4];

/// A row of two vectors, each with padding: force and torque, or velocity and spin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct F64x8(pub(crate) [f64; 8]);

/// Row indices of one block. Those of lanes `lane..lane + WIDTH` were checked to be below a bound.
#[derive(Clone, Copy)]
pub(crate) struct CheckedIndices<'a, L> {
    indices: &'a [u32; BLOCK_SIZE],
    bound: usize,
    lane: usize,
    lanes: PhantomData<L>,
}

impl<'a, L: SimdF64> CheckedIndices<'a, L> {
    /// For lanes `lane..lane + WIDTH`.
    ///
    /// # Panics
    /// Panics if an index is not below the bound.
    #[inline(always)]
    pub(crate) fn new(indices: &'a [u32; BLOCK_SIZE], lane: usize, bound: usize) -> Self {
        assert!(L::all_below(indices, lane, bound), "row index out of bounds");
        let indices = L::launder(indices);
        Self { indices, bound, lane, lanes: PhantomData }
    }

    /// The index in lane `k` of `WIDTH`.
    #[inline(always)]
    pub(crate) fn get(&self, k: usize) -> usize {
        self.indices[self.lane + k] as usize
    }

    #[inline(always)]
    pub(crate) fn bound(&self) -> usize {
        self.bound
    }
}

/// [`Lanes`] with access to blocks of pairs and tables of grains.
pub(crate) trait SimdF64: Lanes {
    /// Lanes in one value; divides [`BLOCK_SIZE`].
    const WIDTH: usize;
    /// A row of a table: four numbers, whatever the width.
    type Row: SimdRow;

    /// Lanes `lane..lane + WIDTH` of a block.
    fn load(from: &[f64; BLOCK_SIZE], lane: usize) -> Self;
    /// Writes lanes `lane..lane + WIDTH` of a block.
    fn store(self, to: &mut [f64; BLOCK_SIZE], lane: usize);
    /// True if indices `lane..lane + WIDTH` of a block are below a bound.
    fn all_below(indices: &[u32; BLOCK_SIZE], lane: usize, bound: usize) -> bool;
    /// These indices, hidden from the optimiser so that they are read from memory one by one: taking them out of a wide
    /// register would cost more.
    #[inline(always)]
    fn launder(indices: &[u32; BLOCK_SIZE]) -> &[u32; BLOCK_SIZE] {
        indices
    }
    /// The first three components of rows of a table.
    ///
    /// # Panics
    /// This and the next three: where a table has fewer rows than the bound of the indices.
    fn gather(table: &[F64x4], at: CheckedIndices<'_, Self>) -> LaneVec3<Self>;
    /// Rows `a` less rows `b`.
    fn gather_difference(
        table: &[F64x4],
        a: CheckedIndices<'_, Self>,
        b: CheckedIndices<'_, Self>,
    ) -> LaneVec3<Self>;
    /// Velocities of `a` less those of `b`, and the sum of their spins.
    fn gather_relative_motion(
        table: &[F64x8],
        a: CheckedIndices<'_, Self>,
        b: CheckedIndices<'_, Self>,
    ) -> [LaneVec3<Self>; 2];
    /// Spins of grains, rad/s.
    fn gather_spins(table: &[F64x8], at: CheckedIndices<'_, Self>) -> LaneVec3<Self>;
    /// Prefetches rows of a table, where the processor can.
    fn prefetch<T>(table: &[T], rows: &[u32; BLOCK_SIZE]);
    /// Adds forces and moments of pairs to their grains, pair after pair: force and moment to row `to` of the sums, the
    /// opposite force and the same moment to row `from` modulo [`CHUNK_SIZE`]. Components 0 to 2 are the force and, where
    /// `MOMENTS`, components 4 to 6 the moment. Where `LEVERS`, component 3 is the lever of the moment on `to`, and
    /// component 7 that on `from`.
    fn scatter_add<const MOMENTS: bool, const LEVERS: bool>(
        components: [Self; 8],
        from: CheckedIndices<'_, Self>,
        to: CheckedIndices<'_, Self>,
        sums: &mut [F64x8],
    );
    /// Adds forces and moments of pairs to their grains, pair after pair: the force to row `to` of the sums, the opposite one
    /// to row `from` modulo [`CHUNK_SIZE`], and the second moment to `to`, the first to `from`.
    #[inline(always)]
    fn scatter_add_each(
        force: LaneVec3<Self>,
        moments: [LaneVec3<Self>; 2],
        from: CheckedIndices<'_, Self>,
        to: CheckedIndices<'_, Self>,
        sums: &mut [F64x8],
    ) {
        let mut components = [[[0.0; BLOCK_SIZE]; 3]; 3];
        for (v, stored) in [force, moments[0], moments[1]].into_iter().zip(&mut components) {
            store_vector(v, stored, 0);
        }
        for k in 0..Self::WIDTH {
            let [f, first, second] = components.map(|v| [v[0][k], v[1][k], v[2][k]]);
            let row = &mut sums[to.get(k)].0;
            for c in 0..3 {
                row[c] += f[c];
                row[4 + c] += second[c];
            }
            let row = &mut sums[from.get(k) % CHUNK_SIZE].0;
            for c in 0..3 {
                row[c] -= f[c];
                row[4 + c] += first[c];
            }
        }
    }
    /// Adds eight components to `sum`, lane after lane.
    #[inline(always)]
    fn reduce_add(components: [Self; 8], sum: &mut [f64; 8]) {
        let mut parts = [[0.0; BLOCK_SIZE]; 8];
        for (part, component) in parts.iter_mut().zip(components) {
            component.store(part, 0);
        }
        for (sum, part) in sum.iter_mut().zip(parts) {
            part[..Self::WIDTH].iter().for_each(|p| *sum += p);
        }
    }
}

/// Four numbers of one grain.
pub(crate) trait SimdRow: Copy {
    fn splat(value: f64) -> Self;
    /// Numbers `at..at + 4`.
    fn load<const N: usize>(from: &[f64; N], at: usize) -> Self;
    /// Writes numbers `at..at + 4`.
    fn store<const N: usize>(self, to: &mut [f64; N], at: usize);
    fn add(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    /// `self` × `factor` + `addend`, rounded once.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// The larger of two; the second where they do not compare.
    fn max(self, other: Self) -> Self;
}

/// Lanes `lane..lane + WIDTH` of a block of vectors.
#[inline(always)]
pub(crate) fn load_vector<L: SimdF64>(from: &[[f64; BLOCK_SIZE]; 3], lane: usize) -> LaneVec3<L> {
    LaneVec3::new(L::load(&from[0], lane), L::load(&from[1], lane), L::load(&from[2], lane))
}

/// Writes lanes `lane..lane + WIDTH` of a block of vectors.
#[inline(always)]
pub(crate) fn store_vector<L: SimdF64>(v: LaneVec3<L>, to: &mut [[f64; BLOCK_SIZE]; 3], lane: usize) {
    v.x.store(&mut to[0], lane);
    v.y.store(&mut to[1], lane);
    v.z.store(&mut to[2], lane);
}
