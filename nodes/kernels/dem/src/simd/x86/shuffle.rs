//! Rows into columns and back.

use super::registers::{Avx2, Avx512};
use grainlab_core::lanes::LaneVec3;
use std::arch::x86_64::*;

#[inline(always)]
pub(super) fn columns4(rows: [__m256d; 4]) -> LaneVec3<Avx2> {
    let [x, y, z, _] = transpose4(rows);
    LaneVec3 { x: Avx2(x), y: Avx2(y), z: Avx2(z) }
}

#[inline(always)]
pub(super) fn columns8(r: [__m256d; 8]) -> LaneVec3<Avx512> {
    unsafe {
        let mut z = [_mm512_setzero_pd(); 4];
        for k in 0..4 {
            z[k] = _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(r[k]), r[k + 4]);
        }
        let (xz01, yw01) = (_mm512_unpacklo_pd(z[0], z[1]), _mm512_unpackhi_pd(z[0], z[1]));
        let (xz23, yw23) = (_mm512_unpacklo_pd(z[2], z[3]), _mm512_unpackhi_pd(z[2], z[3]));
        let first = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
        let second = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
        LaneVec3 {
            x: Avx512(_mm512_permutex2var_pd(xz01, first, xz23)),
            y: Avx512(_mm512_permutex2var_pd(yw01, first, yw23)),
            z: Avx512(_mm512_permutex2var_pd(xz01, second, xz23)),
        }
    }
}

/// The first three columns of eight rows, and the three from the fifth on.
#[inline(always)]
pub(super) fn two_columns8(r: [Avx512; 8]) -> [LaneVec3<Avx512>; 2] {
    unsafe {
        let mut even = [_mm512_setzero_pd(); 4];
        let mut odd = even;
        for k in 0..4 {
            even[k] = _mm512_unpacklo_pd(r[2 * k].0, r[2 * k + 1].0);
            odd[k] = _mm512_unpackhi_pd(r[2 * k].0, r[2 * k + 1].0);
        }
        let [x, z, u, w] = transpose_quarters(even);
        let ab = _mm512_shuffle_f64x2::<0x88>(odd[0], odd[1]);
        let cd = _mm512_shuffle_f64x2::<0x88>(odd[2], odd[3]);
        let (y, v) = (_mm512_shuffle_f64x2::<0x88>(ab, cd), _mm512_shuffle_f64x2::<0xDD>(ab, cd));
        [
            LaneVec3 { x: Avx512(x), y: Avx512(y), z: Avx512(z) },
            LaneVec3 { x: Avx512(u), y: Avx512(v), z: Avx512(w) },
        ]
    }
}

#[inline(always)]
pub(super) fn transpose8(c: [Avx512; 8]) -> [Avx512; 8] {
    unsafe {
        let mut even = [_mm512_setzero_pd(); 4];
        let mut odd = even;
        for k in 0..4 {
            even[k] = _mm512_unpacklo_pd(c[2 * k].0, c[2 * k + 1].0);
            odd[k] = _mm512_unpackhi_pd(c[2 * k].0, c[2 * k + 1].0);
        }
        let (even, odd) = (transpose_quarters(even), transpose_quarters(odd));
        let mut rows = c;
        for k in 0..4 {
            rows[2 * k] = Avx512(even[k]);
            rows[2 * k + 1] = Avx512(odd[k]);
        }
        rows
    }
}

/// Transposes quarters of registers, four by four.
#[inline(always)]
fn transpose_quarters([a, b, c, d]: [__m512d; 4]) -> [__m512d; 4] {
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

#[inline(always)]
pub(super) fn transpose4([x, y, z, w]: [__m256d; 4]) -> [__m256d; 4] {
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
