//! Lanes of x86-64 processors. The only file with `unsafe` in it: intrinsics need it.

use crate::lanes::{BLOCK, Lanes, Quad, Wrench};
use crate::simd::Kernel;
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

// SAFETY, for every block below that only calls arithmetic intrinsics: values of these types are made nowhere but in
// the two functions at the end of this file, which are entered only after the processor was asked for its features.

/// Four lanes: AVX2.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(__m256d);

/// Eight lanes: AVX-512 F, DQ and VL.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(__m512d);

/// Offsets of rows, and the rows that the table must have.
#[derive(Clone, Copy)]
pub(crate) struct Rows<I> {
    offset: I,
    rows: usize,
}

macro_rules! arithmetic {
    ($lanes:ty, $($operator:ident $method:ident $intrinsic:ident),*) => {$(
        impl $operator for $lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    )*};
}

arithmetic!(Avx2, Add add _mm256_add_pd, Sub sub _mm256_sub_pd, Mul mul _mm256_mul_pd, Div div _mm256_div_pd);
arithmetic!(Avx512, Add add _mm512_add_pd, Sub sub _mm512_sub_pd, Mul mul _mm512_mul_pd, Div div _mm512_div_pd);

impl Neg for Avx2 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
}

impl Neg for Avx512 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
}

/// Row numbers are 32-bit offsets of four numbers each.
const MOST_ROWS: usize = 1 << 29;

impl Lanes for Avx2 {
    const WIDTH: usize = 4;
    type Mask = __m256d;
    type Index = Rows<__m128i>;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(unsafe { _mm256_set1_pd(value) })
    }
    #[inline(always)]
    fn load(from: &[f64; BLOCK], lane: usize) -> Self {
        let from: &[f64] = &from[lane..lane + 4];
        // SAFETY: the slice holds four numbers.
        Self(unsafe { _mm256_loadu_pd(from.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f64; BLOCK], lane: usize) {
        let to: &mut [f64] = &mut to[lane..lane + 4];
        // SAFETY: the slice holds four numbers.
        unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) };
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(unsafe { _mm256_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn gt(self, other: Self) -> __m256d {
        unsafe { _mm256_cmp_pd::<_CMP_GT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn any(mask: __m256d) -> bool {
        unsafe { _mm256_movemask_pd(mask) != 0 }
    }
    #[inline(always)]
    fn select(mask: __m256d, a: Self, b: Self) -> Self {
        Self(unsafe { _mm256_blendv_pd(b.0, a.0, mask) })
    }
    #[inline(always)]
    fn index(from: &[u32; BLOCK], lane: usize, rows: usize) -> Rows<__m128i> {
        assert!(rows > 0 && rows <= MOST_ROWS);
        let from: &[u32] = &from[lane..lane + 4];
        // SAFETY: the slice holds four numbers. The offsets stay below 4 × rows.
        unsafe {
            let i = _mm_loadu_si128(from.as_ptr().cast());
            let i = _mm_min_epu32(i, _mm_set1_epi32(rows as i32 - 1));
            Rows { offset: _mm_slli_epi32::<2>(i), rows }
        }
    }
    #[inline(always)]
    fn gather<const K: usize>(table: &[Quad], index: Rows<__m128i>) -> Self {
        const { assert!(K < 4) };
        assert!(table.len() >= index.rows);
        // SAFETY: offsets are those of rows below `rows`, and the table has that many.
        Self(unsafe { _mm256_i32gather_pd::<8>(table.as_ptr().cast::<f64>().add(K), index.offset) })
    }
    #[inline(always)]
    fn prefetch(table: &[Quad], rows: &[u32; BLOCK], lane: usize) {
        prefetch(table, &rows[lane..lane + Self::WIDTH]);
    }
    #[inline(always)]
    fn store_rows([x, y, z, w]: [Self; 4], to: &mut [Wrench; BLOCK], lane: usize, at: usize) {
        let rows = transpose([x.0, y.0, z.0, w.0]);
        for k in 0..4 {
            store_half(rows[k], &mut to[lane + k], at);
        }
    }
    #[inline(always)]
    fn fold(c: [Self; 8], sum: &mut [f64; 8]) {
        let first = transpose([c[0].0, c[1].0, c[2].0, c[3].0]);
        let second = transpose([c[4].0, c[5].0, c[6].0, c[7].0]);
        let (mut low, mut high) = (Self::load(sum, 0), Self::load(sum, 4));
        for k in 0..4 {
            low = low + Self(first[k]);
            high = high + Self(second[k]);
        }
        low.store(sum, 0);
        high.store(sum, 4);
    }
}

/// Asks for rows of a table; rows that it does not have are no harm.
#[inline(always)]
fn prefetch(table: &[Quad], rows: &[u32]) {
    for &row in rows {
        // SAFETY: a prefetch never faults, whatever the address.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(table.as_ptr().wrapping_add(row as usize).cast()) };
    }
}

/// Half a row.
#[inline(always)]
fn store_half(half: __m256d, to: &mut Wrench, at: usize) {
    let to: &mut [f64] = &mut to[at..at + 4];
    // SAFETY: the slice holds four numbers.
    unsafe { _mm256_storeu_pd(to.as_mut_ptr(), half) };
}

/// Four by four.
#[inline(always)]
fn transpose([x, y, z, w]: [__m256d; 4]) -> [__m256d; 4] {
    unsafe {
        let (t0, t1) = (_mm256_unpacklo_pd(x, y), _mm256_unpackhi_pd(x, y));
        let (u0, u1) = (_mm256_unpacklo_pd(z, w), _mm256_unpackhi_pd(z, w));
        [
            _mm256_permute2f128_pd::<0x20>(t0, u0),
            _mm256_permute2f128_pd::<0x20>(t1, u1),
            _mm256_permute2f128_pd::<0x31>(t0, u0),
            _mm256_permute2f128_pd::<0x31>(t1, u1),
        ]
    }
}

impl Lanes for Avx512 {
    const WIDTH: usize = 8;
    type Mask = __mmask8;
    type Index = Rows<__m256i>;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(unsafe { _mm512_set1_pd(value) })
    }
    #[inline(always)]
    fn load(from: &[f64; BLOCK], _: usize) -> Self {
        // SAFETY: a block holds eight numbers.
        Self(unsafe { _mm512_loadu_pd(from.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, to: &mut [f64; BLOCK], _: usize) {
        // SAFETY: a block holds eight numbers.
        unsafe { _mm512_storeu_pd(to.as_mut_ptr(), self.0) };
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(unsafe { _mm512_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn gt(self, other: Self) -> __mmask8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn any(mask: __mmask8) -> bool {
        mask != 0
    }
    #[inline(always)]
    fn select(mask: __mmask8, a: Self, b: Self) -> Self {
        Self(unsafe { _mm512_mask_blend_pd(mask, b.0, a.0) })
    }
    #[inline(always)]
    fn index(from: &[u32; BLOCK], _: usize, rows: usize) -> Rows<__m256i> {
        assert!(rows > 0 && rows <= MOST_ROWS);
        // SAFETY: a block holds eight numbers. The offsets stay below 4 × rows.
        unsafe {
            let i = _mm256_loadu_si256(from.as_ptr().cast());
            let i = _mm256_min_epu32(i, _mm256_set1_epi32(rows as i32 - 1));
            Rows { offset: _mm256_slli_epi32::<2>(i), rows }
        }
    }
    #[inline(always)]
    fn gather<const K: usize>(table: &[Quad], index: Rows<__m256i>) -> Self {
        const { assert!(K < 4) };
        assert!(table.len() >= index.rows);
        // SAFETY: offsets are those of rows below `rows`, and the table has that many.
        Self(unsafe { _mm512_i32gather_pd::<8>(index.offset, table.as_ptr().cast::<f64>().add(K)) })
    }
    #[inline(always)]
    fn prefetch(table: &[Quad], rows: &[u32; BLOCK], lane: usize) {
        prefetch(table, &rows[lane..lane + Self::WIDTH]);
    }
    #[inline(always)]
    fn store_rows([x, y, z, w]: [Self; 4], to: &mut [Wrench; BLOCK], _: usize, at: usize) {
        unsafe {
            let first = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11);
            let second = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
            let (even_xy, odd_xy) = (_mm512_unpacklo_pd(x.0, y.0), _mm512_unpackhi_pd(x.0, y.0));
            let (even_zw, odd_zw) = (_mm512_unpacklo_pd(z.0, w.0), _mm512_unpackhi_pd(z.0, w.0));
            let pairs = [
                (0, _mm512_permutex2var_pd(even_xy, first, even_zw)),
                (1, _mm512_permutex2var_pd(odd_xy, first, odd_zw)),
                (4, _mm512_permutex2var_pd(even_xy, second, even_zw)),
                (5, _mm512_permutex2var_pd(odd_xy, second, odd_zw)),
            ];
            for (row, pair) in pairs {
                store_half(_mm512_castpd512_pd256(pair), &mut to[row], at);
                store_half(_mm512_extractf64x4_pd::<1>(pair), &mut to[row + 2], at);
            }
        }
    }
    #[inline(always)]
    fn fold(c: [Self; 8], sum: &mut [f64; 8]) {
        unsafe {
            let mut even = [_mm512_setzero_pd(); 4];
            let mut odd = even;
            for k in 0..4 {
                even[k] = _mm512_unpacklo_pd(c[2 * k].0, c[2 * k + 1].0);
                odd[k] = _mm512_unpackhi_pd(c[2 * k].0, c[2 * k + 1].0);
            }
            let (even, odd) = (quarters(even), quarters(odd));
            let mut total = _mm512_loadu_pd(sum.as_ptr());
            for k in 0..4 {
                total = _mm512_add_pd(total, even[k]);
                total = _mm512_add_pd(total, odd[k]);
            }
            _mm512_storeu_pd(sum.as_mut_ptr(), total);
        }
    }
}

/// Four by four, of quarters of a register.
#[inline(always)]
fn quarters([a, b, c, d]: [__m512d; 4]) -> [__m512d; 4] {
    unsafe {
        let (ab, cd) = (_mm512_shuffle_f64x2::<0x44>(a, b), _mm512_shuffle_f64x2::<0x44>(c, d));
        let (ab2, cd2) = (_mm512_shuffle_f64x2::<0xEE>(a, b), _mm512_shuffle_f64x2::<0xEE>(c, d));
        [
            _mm512_shuffle_f64x2::<0x88>(ab, cd),
            _mm512_shuffle_f64x2::<0xDD>(ab, cd),
            _mm512_shuffle_f64x2::<0x88>(ab2, cd2),
            _mm512_shuffle_f64x2::<0xDD>(ab2, cd2),
        ]
    }
}

/// Whether the processor has what [`Avx2`] needs.
pub(crate) fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2")
}

/// Whether the processor has what [`Avx512`] needs.
pub(crate) fn has_avx512() -> bool {
    has_avx2()
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

/// Runs a kernel with four lanes, where the processor can.
pub(crate) fn run_avx2<K: Kernel>(kernel: K) -> Result<K::Output, K> {
    #[target_feature(enable = "avx2")]
    fn run<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<Avx2>()
    }
    // SAFETY: the processor was asked.
    if has_avx2() { Ok(unsafe { run(kernel) }) } else { Err(kernel) }
}

/// Runs a kernel with eight lanes, where the processor can.
pub(crate) fn run_avx512<K: Kernel>(kernel: K) -> Result<K::Output, K> {
    #[target_feature(enable = "avx2,avx512f,avx512dq,avx512vl")]
    fn run<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<Avx512>()
    }
    // SAFETY: the processor was asked.
    if has_avx512() { Ok(unsafe { run(kernel) }) } else { Err(kernel) }
}
