//! Registers of x86-64 as lanes.
//!
//! SAFETY, for every `unsafe` block of this folder that only calls arithmetic intrinsics: kernels with these types are
//! entered only through the functions of `mod.rs`, which ask the processor for its features first.

use crate::simd::simd_f64::SimdRow;
use grainlab_core::lanes::{FRACTION, Lanes, RSQRT_MAGIC, WHOLE};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

/// Four lanes: AVX2 with FMA.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(pub(super) __m256d);

/// Eight lanes: AVX-512 F, DQ and VL.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(pub(super) __m512d);

#[derive(Clone, Copy)]
pub(crate) struct F64x4Avx2(pub(super) __m256d);

macro_rules! operators {
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

operators!(Avx2, Add add _mm256_add_pd, Sub sub _mm256_sub_pd, Mul mul _mm256_mul_pd, Div div _mm256_div_pd);
operators!(Avx512, Add add _mm512_add_pd, Sub sub _mm512_sub_pd, Mul mul _mm512_mul_pd, Div div _mm512_div_pd);

/// The methods that both widths write in the same way.
macro_rules! arithmetic {
    ($splat:ident $fmadd:ident $fmsub:ident $fnmadd:ident $sqrt:ident $max:ident
        $bits:ident $shift:ident $left:ident $and:ident $or:ident $integer:ident $sub:ident $float:ident) => {
        #[inline(always)]
        fn splat(value: f64) -> Self {
            Self(unsafe { $splat(value) })
        }
        #[inline(always)]
        fn mul_add(self, factor: Self, addend: Self) -> Self {
            Self(unsafe { $fmadd(self.0, factor.0, addend.0) })
        }
        #[inline(always)]
        fn mul_sub(self, factor: Self, subtrahend: Self) -> Self {
            Self(unsafe { $fmsub(self.0, factor.0, subtrahend.0) })
        }
        #[inline(always)]
        fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
            Self(unsafe { $fnmadd(self.0, factor.0, addend.0) })
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
        fn rsqrt_estimate(self) -> Self {
            unsafe {
                let half = $shift::<1>($bits(self.0));
                Self($float($sub($integer(RSQRT_MAGIC as i64), half)))
            }
        }
        #[inline(always)]
        fn split(self) -> (Self, Self) {
            unsafe {
                let bits = $bits(self.0);
                let exponent = Self($float($or($shift::<52>(bits), $integer(WHOLE.to_bits() as i64))));
                let fraction = $or($and(bits, $integer(FRACTION as i64)), $integer(1f64.to_bits() as i64));
                (exponent - Self::splat(WHOLE + 1023.0), Self($float(fraction)))
            }
        }
        #[inline(always)]
        fn power_of_two(self) -> Self {
            Self(unsafe { $float($left::<52>($bits((self + Self::splat(WHOLE + 1023.0)).0))) })
        }
    };
}

impl Lanes for Avx2 {
    type Mask = __m256d;

    arithmetic!(_mm256_set1_pd _mm256_fmadd_pd _mm256_fmsub_pd _mm256_fnmadd_pd _mm256_sqrt_pd _mm256_max_pd
        _mm256_castpd_si256 _mm256_srli_epi64 _mm256_slli_epi64 _mm256_and_si256 _mm256_or_si256
        _mm256_set1_epi64x _mm256_sub_epi64 _mm256_castsi256_pd);

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
}

impl Lanes for Avx512 {
    type Mask = __mmask8;

    arithmetic!(_mm512_set1_pd _mm512_fmadd_pd _mm512_fmsub_pd _mm512_fnmadd_pd _mm512_sqrt_pd _mm512_max_pd
        _mm512_castpd_si512 _mm512_srli_epi64 _mm512_slli_epi64 _mm512_and_si512 _mm512_or_si512
        _mm512_set1_epi64 _mm512_sub_epi64 _mm512_castsi512_pd);

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
}

impl SimdRow for F64x4Avx2 {
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
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(Avx2(self.0).mul_add(Avx2(factor.0), Avx2(addend.0)).0)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(Avx2(self.0).max(Avx2(other.0)).0)
    }
}
