//! Loads, gathers and sums of lanes on x86-64.

use super::registers::{Avx2, Avx512, F64x4Avx2};
use super::shuffle::{columns4, columns8, transpose4, transpose8, two_columns8};
use crate::simd::simd_f64::{BLOCK_SIZE, CHUNK_SIZE, CheckedIndices, F64x4, F64x8, SimdF64, SimdRow};
use grainlab_core::lanes::{LaneVec3, Lanes};
use std::arch::x86_64::*;

/// The methods that both widths write in the same way; `columns` makes vectors of rows.
macro_rules! gathers {
    ($columns:ident) => {
        #[inline(always)]
        fn launder(indices: &[u32; BLOCK_SIZE]) -> &[u32; BLOCK_SIZE] {
            launder(indices)
        }
        #[inline(always)]
        fn gather(table: &[F64x4], at: CheckedIndices<'_, Self>) -> LaneVec3<Self> {
            $columns(load_rows(table, at, false))
        }
        #[inline(always)]
        fn gather_difference(
            table: &[F64x4],
            a: CheckedIndices<'_, Self>,
            b: CheckedIndices<'_, Self>,
        ) -> LaneVec3<Self> {
            $columns(sub_rows(load_rows(table, a, false), load_rows(table, b, false)))
        }
        #[inline(always)]
        fn gather_spins(table: &[F64x8], at: CheckedIndices<'_, Self>) -> LaneVec3<Self> {
            $columns(load_rows(table, at, true))
        }
        #[inline(always)]
        fn prefetch<T>(table: &[T], rows: &[u32; BLOCK_SIZE]) {
            for &row in rows {
                // SAFETY: a prefetch never faults, whatever the address.
                unsafe { _mm_prefetch::<_MM_HINT_T0>(table.as_ptr().wrapping_add(row as usize).cast()) };
            }
        }
    };
}

/// Four numbers of each of `N` rows of a table, from the first or the fifth on.
#[inline(always)]
fn load_rows<L: SimdF64, T: Copy, const N: usize>(
    table: &[T],
    at: CheckedIndices<'_, L>,
    second_half: bool,
) -> [__m256d; N] {
    const { assert!(N == L::WIDTH && (size_of::<T>() == 32 || size_of::<T>() == 64)) };
    assert!(table.len() >= at.bound() && (!second_half || size_of::<T>() == 64));
    // SAFETY: the table has all rows below that bound, and these four numbers in each.
    unsafe {
        let mut rows = [_mm256_setzero_pd(); N];
        for (k, row) in rows.iter_mut().enumerate() {
            let at = table.as_ptr().add(at.get(k)).cast::<f64>();
            *row = _mm256_loadu_pd(at.add(if second_half { 4 } else { 0 }));
        }
        rows
    }
}

/// This reference, hidden from the optimiser: it cannot tell that the memory was read before.
#[inline(always)]
#[allow(clippy::pointers_in_nomem_asm_block)] // nothing is read or written through it
fn launder<T>(of: &T) -> &T {
    let mut place: *const T = of;
    // SAFETY: the pointer is not changed.
    unsafe {
        std::arch::asm!("/* {0} */", inout(reg) place, options(pure, nomem, nostack, preserves_flags));
        &*place
    }
}

#[inline(always)]
fn sub_rows<const N: usize>(mut a: [__m256d; N], b: [__m256d; N]) -> [__m256d; N] {
    for k in 0..N {
        a[k] = unsafe { _mm256_sub_pd(a[k], b[k]) };
    }
    a
}

#[inline(always)]
fn add_rows<const N: usize>(mut a: [__m256d; N], b: [__m256d; N]) -> [__m256d; N] {
    for k in 0..N {
        a[k] = unsafe { _mm256_add_pd(a[k], b[k]) };
    }
    a
}

impl SimdF64 for Avx2 {
    const WIDTH: usize = 4;
    type Row = F64x4Avx2;

    gathers!(columns4);

    #[inline(always)]
    fn load(from: &[f64; BLOCK_SIZE], lane: usize) -> Self {
        Self(F64x4Avx2::load(from, lane).0)
    }
    #[inline(always)]
    fn store(self, to: &mut [f64; BLOCK_SIZE], lane: usize) {
        F64x4Avx2(self.0).store(to, lane);
    }
    #[inline(always)]
    fn all_below(indices: &[u32; BLOCK_SIZE], lane: usize, bound: usize) -> bool {
        let (indices, bound): (&[u32], _) = (&indices[lane..lane + 4], bound.min(u32::MAX as usize) as u32);
        // SAFETY: the slice holds four numbers.
        unsafe {
            let indices = _mm_loadu_si128(indices.as_ptr().cast());
            // An index at or beyond the bound is the larger of both.
            let beyond = _mm_cmpeq_epi32(_mm_max_epu32(indices, _mm_set1_epi32(bound as i32)), indices);
            _mm_testz_si128(beyond, beyond) != 0
        }
    }
    #[inline(always)]
    fn gather_relative_motion(
        table: &[F64x8],
        a: CheckedIndices<'_, Self>,
        b: CheckedIndices<'_, Self>,
    ) -> [LaneVec3<Self>; 2] {
        let velocity = columns4(sub_rows(load_rows(table, a, false), load_rows(table, b, false)));
        [velocity, columns4(add_rows(load_rows(table, a, true), load_rows(table, b, true)))]
    }
    #[inline(always)]
    fn scatter_add<const MOMENTS: bool, const LEVERS: bool>(
        c: [Self; 8],
        from: CheckedIndices<'_, Self>,
        to: CheckedIndices<'_, Self>,
        sums: &mut [F64x8],
    ) {
        let force = transpose4([c[0].0, c[1].0, c[2].0, c[3].0]);
        let moment = transpose4([c[4].0, c[5].0, c[6].0, c[7].0]);
        for k in 0..4 {
            let (force, moment) = (Self(force[k]), Self(moment[k]));
            let (mut on_second, mut on_first) = (moment, moment);
            if LEVERS {
                (on_second, on_first) = (moment * last_lane(force), moment * last_lane(moment));
                (on_second, on_first) = (clear_last_lane(on_second), clear_last_lane(on_first));
            }
            let force = if LEVERS { clear_last_lane(force) } else { force };
            let second = &mut sums[to.get(k)].0;
            (load_half(second, 0) + force).store_half(second, 0);
            if MOMENTS {
                (load_half(second, 4) + on_second).store_half(second, 4);
            }
            let first = &mut sums[from.get(k) % CHUNK_SIZE].0;
            (load_half(first, 0) - force).store_half(first, 0);
            if MOMENTS {
                (load_half(first, 4) + on_first).store_half(first, 4);
            }
        }
    }
}

/// Numbers `at..at + 4` of a row.
#[inline(always)]
fn load_half(row: &[f64; 8], at: usize) -> Avx2 {
    Avx2(F64x4Avx2::load(row, at).0)
}

impl Avx2 {
    /// Writes numbers `at..at + 4` of a row.
    #[inline(always)]
    fn store_half(self, row: &mut [f64; 8], at: usize) {
        F64x4Avx2(self.0).store(row, at);
    }
}

/// The last lane, in all four.
#[inline(always)]
fn last_lane(row: Avx2) -> Avx2 {
    Avx2(unsafe { _mm256_permute4x64_pd::<0xFF>(row.0) })
}

/// The first three lanes, and zero in the last.
#[inline(always)]
fn clear_last_lane(row: Avx2) -> Avx2 {
    Avx2(unsafe { _mm256_blend_pd::<8>(row.0, _mm256_setzero_pd()) })
}

impl SimdF64 for Avx512 {
    const WIDTH: usize = 8;
    type Row = F64x4Avx2;

    gathers!(columns8);

    #[inline(always)]
    fn load(from: &[f64; BLOCK_SIZE], _: usize) -> Self {
        // SAFETY: a block holds eight numbers.
        Self(unsafe { _mm512_loadu_pd(from.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f64; BLOCK_SIZE], _: usize) {
        // SAFETY: a block holds eight numbers.
        unsafe { _mm512_storeu_pd(to.as_mut_ptr(), self.0) };
    }
    #[inline(always)]
    fn all_below(indices: &[u32; BLOCK_SIZE], _: usize, bound: usize) -> bool {
        let bound = bound.min(u32::MAX as usize) as u32;
        // SAFETY: a block holds eight numbers.
        unsafe {
            let indices = _mm256_loadu_si256(indices.as_ptr().cast());
            _mm256_cmpge_epu32_mask(indices, _mm256_set1_epi32(bound as i32)) == 0
        }
    }
    #[inline(always)]
    fn gather_relative_motion(
        table: &[F64x8],
        a: CheckedIndices<'_, Self>,
        b: CheckedIndices<'_, Self>,
    ) -> [LaneVec3<Self>; 2] {
        assert!(table.len() >= a.bound().max(b.bound()));
        let sign = Self(unsafe { _mm512_setr_pd(-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0) });
        let mut rows = [sign; 8];
        for (k, row) in rows.iter_mut().enumerate() {
            // SAFETY: the table has these rows.
            let (a, b) = unsafe { (table.get_unchecked(a.get(k)), table.get_unchecked(b.get(k))) };
            *row = Self::load(&b.0, 0).mul_add(sign, Self::load(&a.0, 0));
        }
        two_columns8(rows)
    }
    #[inline(always)]
    fn scatter_add<const MOMENTS: bool, const LEVERS: bool>(
        c: [Self; 8],
        from: CheckedIndices<'_, Self>,
        to: CheckedIndices<'_, Self>,
        sums: &mut [F64x8],
    ) {
        assert!(sums.len() >= to.bound());
        let rows = transpose8(c);
        if !MOMENTS {
            for k in 0..BLOCK_SIZE {
                let second = &mut sums[to.get(k)].0;
                (load_half(second, 0) + rows[k].lower()).store_half(second, 0);
                let first = &mut sums[from.get(k) % CHUNK_SIZE].0;
                (load_half(first, 0) - rows[k].lower()).store_half(first, 0);
            }
            return;
        }
        // The padding is left out.
        let same = Self(unsafe { _mm512_setr_pd(1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0) });
        let opposite = Self(unsafe { _mm512_setr_pd(-1.0, -1.0, -1.0, 0.0, 1.0, 1.0, 1.0, 0.0) });
        for (k, row) in rows.iter().enumerate() {
            let row = *row;
            // SAFETY: asserted.
            let second = unsafe { &mut sums.get_unchecked_mut(to.get(k)).0 };
            let on_second = if LEVERS { row * same.with_upper(row, 3) } else { row };
            (Self::load(second, 0) + on_second).store(second, 0);
            let first = &mut sums[from.get(k) % CHUNK_SIZE].0;
            let before = Self::load(first, 0);
            let after = if LEVERS {
                before + row * opposite.with_upper(row, 7)
            } else {
                row.mul_add(opposite, before)
            };
            after.store(first, 0);
        }
    }
}

impl Avx512 {
    /// Lanes 0 to 3.
    #[inline(always)]
    fn lower(self) -> Avx2 {
        Avx2(unsafe { _mm512_castpd512_pd256(self.0) })
    }

    /// The number in `column` of `row` in lanes 4, 5 and 6.
    #[inline(always)]
    fn with_upper(self, row: Self, column: i64) -> Self {
        Self(unsafe { _mm512_mask_permutexvar_pd(self.0, 0x70, _mm512_set1_epi64(column), row.0) })
    }
}
