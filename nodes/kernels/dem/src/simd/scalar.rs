//! One lane, on any processor: the reference that the other widths agree with bit for bit.

use super::simd_f64::{BLOCK_SIZE, CHUNK_SIZE, CheckedIndices, F64x4, F64x8, SimdF64, SimdRow};
use grainlab_core::lanes::{LaneVec3, Lanes};

impl SimdRow for F64x4 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        [value; 4]
    }
    #[inline(always)]
    fn load<const N: usize>(from: &[f64; N], at: usize) -> Self {
        [from[at], from[at + 1], from[at + 2], from[at + 3]]
    }
    #[inline(always)]
    fn store<const N: usize>(self, to: &mut [f64; N], at: usize) {
        to[at..at + 4].copy_from_slice(&self);
    }
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        [self[0] + o[0], self[1] + o[1], self[2] + o[2], self[3] + o[3]]
    }
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        [self[0] * o[0], self[1] * o[1], self[2] * o[2], self[3] * o[3]]
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let mut result = addend;
        for k in 0..4 {
            result[k] = f64::mul_add(self[k], factor[k], addend[k]);
        }
        result
    }
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        let mut largest = o;
        for k in 0..4 {
            largest[k] = Lanes::max(self[k], o[k]);
        }
        largest
    }
}

impl SimdF64 for f64 {
    const WIDTH: usize = 1;
    type Row = F64x4;

    #[inline(always)]
    fn load(from: &[f64; BLOCK_SIZE], lane: usize) -> Self {
        from[lane]
    }
    #[inline(always)]
    fn store(self, to: &mut [f64; BLOCK_SIZE], lane: usize) {
        to[lane] = self;
    }
    #[inline(always)]
    fn all_below(indices: &[u32; BLOCK_SIZE], lane: usize, bound: usize) -> bool {
        (indices[lane] as usize) < bound
    }
    #[inline(always)]
    fn gather(table: &[F64x4], at: CheckedIndices<'_, Self>) -> LaneVec3<Self> {
        let [x, y, z, _] = table[at.get(0)];
        LaneVec3 { x, y, z }
    }
    #[inline(always)]
    fn gather_difference(
        table: &[F64x4],
        a: CheckedIndices<'_, Self>,
        b: CheckedIndices<'_, Self>,
    ) -> LaneVec3<Self> {
        Self::gather(table, a) - Self::gather(table, b)
    }
    #[inline(always)]
    fn gather_relative_motion(
        table: &[F64x8],
        a: CheckedIndices<'_, Self>,
        b: CheckedIndices<'_, Self>,
    ) -> [LaneVec3<Self>; 2] {
        let (p, q) = (&table[a.get(0)].0, &table[b.get(0)].0);
        let velocity = LaneVec3 { x: p[0] - q[0], y: p[1] - q[1], z: p[2] - q[2] };
        [velocity, LaneVec3 { x: p[4] + q[4], y: p[5] + q[5], z: p[6] + q[6] }]
    }
    #[inline(always)]
    fn gather_spins(table: &[F64x8], at: CheckedIndices<'_, Self>) -> LaneVec3<Self> {
        let row = &table[at.get(0)].0;
        LaneVec3 { x: row[4], y: row[5], z: row[6] }
    }
    #[inline(always)]
    fn prefetch<T>(_: &[T], _: &[u32; BLOCK_SIZE]) {}
    #[inline(always)]
    fn scatter_add<const MOMENTS: bool, const LEVERS: bool>(
        c: [Self; 8],
        from: CheckedIndices<'_, Self>,
        to: CheckedIndices<'_, Self>,
        sums: &mut [F64x8],
    ) {
        let second = &mut sums[to.get(0)].0;
        for k in 0..3 {
            second[k] += c[k];
            if MOMENTS {
                second[4 + k] += if LEVERS { c[4 + k] * c[3] } else { c[4 + k] };
            }
        }
        let first = &mut sums[from.get(0) % CHUNK_SIZE].0;
        for k in 0..3 {
            first[k] -= c[k];
            if MOMENTS {
                first[4 + k] += if LEVERS { c[4 + k] * c[7] } else { c[4 + k] };
            }
        }
    }
}
