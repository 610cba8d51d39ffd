//! Lanes of x86-64 processors. The only file with `unsafe` in it: intrinsics need it.

use crate::lanes::{ABOUT_INVERSE_ROOT, BLOCK, CHUNK, Lanes, Octad, Quad, Row, Rows, V3};
use crate::simd::Kernel;
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

// SAFETY, for every block below that only calls arithmetic intrinsics: values of these types are made nowhere but in
// the two functions at the end of this file, which are entered only after the processor was asked for its features.

/// Four lanes: AVX2 with FMA.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(__m256d);

/// Eight lanes: AVX-512 F, DQ and VL.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(__m512d);

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

/// What both kinds of lanes do in the same way.
macro_rules! alike {
    ($splat:ident $fmadd:ident $fmsub:ident $fnmadd:ident $sqrt:ident $max:ident $columns:ident
        $bits:ident $half:ident $number:ident $less:ident $float:ident) => {
        #[inline(always)]
        fn splat(value: f64) -> Self {
            Self(unsafe { $splat(value) })
        }
        #[inline(always)]
        fn mul_add(self, by: Self, plus: Self) -> Self {
            Self(unsafe { $fmadd(self.0, by.0, plus.0) })
        }
        #[inline(always)]
        fn mul_sub(self, by: Self, minus: Self) -> Self {
            Self(unsafe { $fmsub(self.0, by.0, minus.0) })
        }
        #[inline(always)]
        fn mul_sub_from(self, by: Self, from: Self) -> Self {
            Self(unsafe { $fnmadd(self.0, by.0, from.0) })
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { $sqrt(self.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(unsafe { $max(self.0, other.0) })
        }
        #[inline(always)]
        fn about_inverse_root(self) -> Self {
            unsafe {
                let half = $half::<1>($bits(self.0));
                Self($float($less($number(ABOUT_INVERSE_ROOT as i64), half)))
            }
        }
        #[inline(always)]
        fn anew(number: &[u32; BLOCK]) -> &[u32; BLOCK] {
            unseen(number)
        }
        #[inline(always)]
        fn rows(table: &[Quad], at: Rows<'_, Self>) -> V3<Self> {
            $columns(rows(table, at, false))
        }
        #[inline(always)]
        fn difference(table: &[Quad], a: Rows<'_, Self>, b: Rows<'_, Self>) -> V3<Self> {
            $columns(less(rows(table, a, false), rows(table, b, false)))
        }
        #[inline(always)]
        fn spins(table: &[Octad], at: Rows<'_, Self>) -> V3<Self> {
            $columns(rows(table, at, true))
        }
        #[inline(always)]
        fn prefetch<T>(table: &[T], rows: &[u32; BLOCK]) {
            for &row in rows {
                // SAFETY: a prefetch never faults, whatever the address.
                unsafe { _mm_prefetch::<_MM_HINT_T0>(table.as_ptr().wrapping_add(row as usize).cast()) };
            }
        }
    };
}

/// Four numbers of each of `N` rows of a table, from the first or the fifth on.
#[inline(always)]
fn rows<L: Lanes, T: Copy, const N: usize>(table: &[T], at: Rows<'_, L>, second: bool) -> [__m256d; N] {
    const { assert!(N == L::WIDTH && (size_of::<T>() == 32 || size_of::<T>() == 64)) };
    assert!(table.len() >= at.below() && (!second || size_of::<T>() == 64));
    // SAFETY: the table has all rows below that bound, and these four numbers in each.
    unsafe {
        let mut rows = [_mm256_setzero_pd(); N];
        for (k, row) in rows.iter_mut().enumerate() {
            let at = table.as_ptr().add(at.number(k)).cast::<f64>();
            *row = _mm256_loadu_pd(at.add(if second { 4 } else { 0 }));
        }
        rows
    }
}

/// The same place, of which the compiler does not know that it was read before.
#[inline(always)]
#[allow(clippy::pointers_in_nomem_asm_block)] // nothing is read or written through it
fn unseen<T>(of: &T) -> &T {
    let mut place: *const T = of;
    // SAFETY: nothing is done to it.
    unsafe {
        std::arch::asm!("/* {0} */", inout(reg) place, options(pure, nomem, nostack, preserves_flags));
        &*place
    }
}

/// Row by row, `a` less `b`.
#[inline(always)]
fn less<const N: usize>(mut a: [__m256d; N], b: [__m256d; N]) -> [__m256d; N] {
    for k in 0..N {
        a[k] = unsafe { _mm256_sub_pd(a[k], b[k]) };
    }
    a
}

/// Row by row, `a` and `b`.
#[inline(always)]
fn both<const N: usize>(mut a: [__m256d; N], b: [__m256d; N]) -> [__m256d; N] {
    for k in 0..N {
        a[k] = unsafe { _mm256_add_pd(a[k], b[k]) };
    }
    a
}

/// Columns of four rows.
#[inline(always)]
fn columns4(rows: [__m256d; 4]) -> V3<Avx2> {
    let [x, y, z, _] = transpose(rows);
    V3 { x: Avx2(x), y: Avx2(y), z: Avx2(z) }
}

/// Columns of eight rows.
#[inline(always)]
fn columns8(r: [__m256d; 8]) -> V3<Avx512> {
    unsafe {
        let mut z = [_mm512_setzero_pd(); 4];
        for k in 0..4 {
            z[k] = _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(r[k]), r[k + 4]);
        }
        let (xz01, yw01) = (_mm512_unpacklo_pd(z[0], z[1]), _mm512_unpackhi_pd(z[0], z[1]));
        let (xz23, yw23) = (_mm512_unpacklo_pd(z[2], z[3]), _mm512_unpackhi_pd(z[2], z[3]));
        let first = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
        let second = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
        V3 {
            x: Avx512(_mm512_permutex2var_pd(xz01, first, xz23)),
            y: Avx512(_mm512_permutex2var_pd(yw01, first, yw23)),
            z: Avx512(_mm512_permutex2var_pd(xz01, second, xz23)),
        }
    }
}

/// A row of a table.
#[derive(Clone, Copy)]
pub(crate) struct Four(__m256d);

impl Row for Four {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(unsafe { _mm256_set1_pd(value) })
    }
    #[inline(always)]
    fn load<const N: usize>(from: &[f64; N], at: usize) -> Self {
        let from: &[f64] = &from[at..at + 4];
        // SAFETY: the slice holds four numbers.
        Self(unsafe { _mm256_loadu_pd(from.as_ptr()) })
    }
    #[inline(always)]
    fn store<const N: usize>(self, to: &mut [f64; N], at: usize) {
        let to: &mut [f64] = &mut to[at..at + 4];
        // SAFETY: the slice holds four numbers.
        unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) };
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self((Avx2(self.0) + Avx2(other.0)).0)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self((Avx2(self.0) * Avx2(other.0)).0)
    }
    #[inline(always)]
    fn mul_add(self, by: Self, plus: Self) -> Self {
        Self(Avx2(self.0).mul_add(Avx2(by.0), Avx2(plus.0)).0)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(Avx2(self.0).max(Avx2(other.0)).0)
    }
}

impl Lanes for Avx2 {
    const WIDTH: usize = 4;
    type Mask = __m256d;
    type Row = Four;

    alike!(_mm256_set1_pd _mm256_fmadd_pd _mm256_fmsub_pd _mm256_fnmadd_pd _mm256_sqrt_pd _mm256_max_pd columns4
        _mm256_castpd_si256 _mm256_srli_epi64 _mm256_set1_epi64x _mm256_sub_epi64 _mm256_castsi256_pd);

    #[inline(always)]
    fn load(from: &[f64; BLOCK], lane: usize) -> Self {
        Self(Four::load(from, lane).0)
    }
    #[inline(always)]
    fn store(self, to: &mut [f64; BLOCK], lane: usize) {
        Four(self.0).store(to, lane);
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
    fn are_below(number: &[u32; BLOCK], lane: usize, bound: usize) -> bool {
        let (number, bound): (&[u32], _) = (&number[lane..lane + 4], bound.min(u32::MAX as usize) as u32);
        // SAFETY: the slice holds four numbers.
        unsafe {
            let number = _mm_loadu_si128(number.as_ptr().cast());
            // Where the bound is no larger than a number, the larger of both is that number.
            let beyond = _mm_cmpeq_epi32(_mm_max_epu32(number, _mm_set1_epi32(bound as i32)), number);
            _mm_testz_si128(beyond, beyond) != 0
        }
    }
    #[inline(always)]
    fn relative(table: &[Octad], a: Rows<'_, Self>, b: Rows<'_, Self>) -> [V3<Self>; 2] {
        let velocity = columns4(less(rows(table, a, false), rows(table, b, false)));
        [velocity, columns4(both(rows(table, a, true), rows(table, b, true)))]
    }
    #[inline(always)]
    fn scatter<const TURN: bool, const LEVERS: bool>(
        c: [Self; 8],
        from: Rows<'_, Self>,
        to: Rows<'_, Self>,
        sums: &mut [Octad],
    ) {
        let force = transpose([c[0].0, c[1].0, c[2].0, c[3].0]);
        let moment = transpose([c[4].0, c[5].0, c[6].0, c[7].0]);
        for k in 0..4 {
            let (force, moment) = (Self(force[k]), Self(moment[k]));
            let (mut on_second, mut on_first) = (moment, moment);
            if LEVERS {
                (on_second, on_first) = (moment * last(force), moment * last(moment));
                (on_second, on_first) = (without_spare(on_second), without_spare(on_first));
            }
            let force = if LEVERS { without_spare(force) } else { force };
            let second = &mut sums[to.number(k)].0;
            (Self::load(second, 0) + force).store(second, 0);
            if TURN {
                (Self::load(second, 4) + on_second).store(second, 4);
            }
            let first = &mut sums[from.number(k) % CHUNK].0;
            (Self::load(first, 0) - force).store(first, 0);
            if TURN {
                (Self::load(first, 4) + on_first).store(first, 4);
            }
        }
    }
}

/// The last of four lanes in all.
#[inline(always)]
fn last(row: Avx2) -> Avx2 {
    Avx2(unsafe { _mm256_permute4x64_pd::<0xFF>(row.0) })
}

/// The first three of four lanes.
#[inline(always)]
fn without_spare(row: Avx2) -> Avx2 {
    Avx2(unsafe { _mm256_blend_pd::<8>(row.0, _mm256_setzero_pd()) })
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
    type Row = Four;

    alike!(_mm512_set1_pd _mm512_fmadd_pd _mm512_fmsub_pd _mm512_fnmadd_pd _mm512_sqrt_pd _mm512_max_pd columns8
        _mm512_castpd_si512 _mm512_srli_epi64 _mm512_set1_epi64 _mm512_sub_epi64 _mm512_castsi512_pd);

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
    fn are_below(number: &[u32; BLOCK], _: usize, bound: usize) -> bool {
        let bound = bound.min(u32::MAX as usize) as u32;
        // SAFETY: a block holds eight numbers.
        unsafe {
            let number = _mm256_loadu_si256(number.as_ptr().cast());
            _mm256_cmpge_epu32_mask(number, _mm256_set1_epi32(bound as i32)) == 0
        }
    }
    #[inline(always)]
    fn relative(table: &[Octad], a: Rows<'_, Self>, b: Rows<'_, Self>) -> [V3<Self>; 2] {
        assert!(table.len() >= a.below().max(b.below()));
        let sign = Self(unsafe { _mm512_setr_pd(-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0) });
        let mut rows = [sign; 8];
        for (k, row) in rows.iter_mut().enumerate() {
            // SAFETY: the table has these rows.
            let (a, b) = unsafe { (table.get_unchecked(a.number(k)), table.get_unchecked(b.number(k))) };
            *row = Self::load(&b.0, 0).mul_add(sign, Self::load(&a.0, 0));
        }
        columns_of(rows)
    }
    #[inline(always)]
    fn scatter<const TURN: bool, const LEVERS: bool>(
        c: [Self; 8],
        from: Rows<'_, Self>,
        to: Rows<'_, Self>,
        sums: &mut [Octad],
    ) {
        assert!(sums.len() >= to.below());
        let rows = rows_of(c);
        if !TURN {
            for k in 0..BLOCK {
                let second = &mut sums[to.number(k)].0;
                (Avx2::load(second, 0) + rows[k].lower()).store(second, 0);
                let first = &mut sums[from.number(k) % CHUNK].0;
                (Avx2::load(first, 0) - rows[k].lower()).store(first, 0);
            }
            return;
        }
        // Spares are left out.
        let same = Self(unsafe { _mm512_setr_pd(1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0) });
        let opposite = Self(unsafe { _mm512_setr_pd(-1.0, -1.0, -1.0, 0.0, 1.0, 1.0, 1.0, 0.0) });
        for (k, row) in rows.iter().enumerate() {
            let row = *row;
            // SAFETY: asserted.
            let second = unsafe { &mut sums.get_unchecked_mut(to.number(k)).0 };
            let by = if LEVERS { row * same.with_upper(row, 3) } else { row };
            (Self::load(second, 0) + by).store(second, 0);
            let first = &mut sums[from.number(k) % CHUNK].0;
            let was = Self::load(first, 0);
            let now =
                if LEVERS { was + row * opposite.with_upper(row, 7) } else { row.mul_add(opposite, was) };
            now.store(first, 0);
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

/// Of eight rows the first three columns, and three from the fifth on.
#[inline(always)]
fn columns_of(r: [Avx512; 8]) -> [V3<Avx512>; 2] {
    unsafe {
        let mut even = [_mm512_setzero_pd(); 4];
        let mut odd = even;
        for k in 0..4 {
            even[k] = _mm512_unpacklo_pd(r[2 * k].0, r[2 * k + 1].0);
            odd[k] = _mm512_unpackhi_pd(r[2 * k].0, r[2 * k + 1].0);
        }
        let [x, z, u, w] = quarters(even);
        let ab = _mm512_shuffle_f64x2::<0x88>(odd[0], odd[1]);
        let cd = _mm512_shuffle_f64x2::<0x88>(odd[2], odd[3]);
        let (y, v) = (_mm512_shuffle_f64x2::<0x88>(ab, cd), _mm512_shuffle_f64x2::<0xDD>(ab, cd));
        [V3 { x: Avx512(x), y: Avx512(y), z: Avx512(z) }, V3 { x: Avx512(u), y: Avx512(v), z: Avx512(w) }]
    }
}

/// Eight by eight.
#[inline(always)]
fn rows_of(c: [Avx512; 8]) -> [Avx512; 8] {
    unsafe {
        let mut even = [_mm512_setzero_pd(); 4];
        let mut odd = even;
        for k in 0..4 {
            even[k] = _mm512_unpacklo_pd(c[2 * k].0, c[2 * k + 1].0);
            odd[k] = _mm512_unpackhi_pd(c[2 * k].0, c[2 * k + 1].0);
        }
        let (even, odd) = (quarters(even), quarters(odd));
        let mut rows = c;
        for k in 0..4 {
            rows[2 * k] = Avx512(even[k]);
            rows[2 * k + 1] = Avx512(odd[k]);
        }
        rows
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
    is_x86_feature_detected!("avx2") && has_fma()
}

/// Whether the processor has a fused multiply-add.
fn has_fma() -> bool {
    is_x86_feature_detected!("fma")
}

/// Whether the processor has what [`Avx512`] needs.
pub(crate) fn has_avx512() -> bool {
    has_avx2()
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

macro_rules! entry {
    ($($what:literal $run:ident $lanes:ty, $features:literal if $has:ident;)*) => {$(
        #[doc = concat!("Runs a kernel with ", $what, ", where the processor can.")]
        pub(crate) fn $run<K: Kernel>(kernel: K) -> Result<K::Output, K> {
            #[target_feature(enable = $features)]
            fn run<K: Kernel>(kernel: K) -> K::Output {
                kernel.run::<$lanes>()
            }
            // SAFETY: the processor was asked.
            if $has() { Ok(unsafe { run(kernel) }) } else { Err(kernel) }
        }
    )*};
}

entry! {
    // Without a fused multiply-add a library call does it.
    "one lane" run_scalar f64, "fma" if has_fma;
    "four lanes" run_avx2 Avx2, "avx2,fma" if has_avx2;
    "eight lanes" run_avx512 Avx512, "avx2,fma,avx512f,avx512dq,avx512vl" if has_avx512;
}
