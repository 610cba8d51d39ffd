//! Eight columns at once, in either precision, with the vector instructions of the processor.
//!
//! Each operation is rounded in the same way on every processor (a multiply-add once), and no operation mixes
//! columns, so that all implementations give the same bits.

use std::marker::PhantomData;
use std::ops::{Add, Mul, Neg};

/// Columns solved at once: one vector register of `f32` on most processors.
pub(crate) const WIDTH: usize = 8;

/// `f32` or `f64`.
pub(crate) trait Real: Copy + Add<Output = Self> + Mul<Output = Self> + Neg<Output = Self> {
    const ZERO: Self;
    /// Rounded to nearest.
    fn of(value: f64) -> Self;
    fn wide(self) -> f64;
    /// self · factor + term, rounded once.
    fn times_plus(self, factor: Self, term: Self) -> Self;
}

macro_rules! real {
    ($t:ty) => {
        impl Real for $t {
            const ZERO: Self = 0.0;
            #[inline(always)]
            fn of(value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn wide(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn times_plus(self, factor: Self, term: Self) -> Self {
                self.mul_add(factor, term)
            }
        }
    };
}
real!(f32);
real!(f64);

/// Arithmetic on eight columns.
pub(crate) trait Lanes: Copy {
    type T: Real;
    type Row: Copy;
    fn load(self, from: &[Self::T; WIDTH]) -> Self::Row;
    fn store(self, row: Self::Row, to: &mut [Self::T; WIDTH]);
    fn splat(self, value: Self::T) -> Self::Row;
    fn add(self, a: Self::Row, b: Self::Row) -> Self::Row;
    fn mul(self, a: Self::Row, b: Self::Row) -> Self::Row;
    /// a b + c.
    fn mul_add(self, a: Self::Row, b: Self::Row, c: Self::Row) -> Self::Row;
    /// c − a b.
    fn mul_sub_from(self, a: Self::Row, b: Self::Row, c: Self::Row) -> Self::Row;
}

/// Portable implementation, one column after the other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plain<T>(pub(crate) PhantomData<T>);

impl<T: Real> Lanes for Plain<T> {
    type T = T;
    type Row = [T; WIDTH];

    #[inline(always)]
    fn load(self, from: &[T; WIDTH]) -> [T; WIDTH] {
        *from
    }

    #[inline(always)]
    fn store(self, row: [T; WIDTH], to: &mut [T; WIDTH]) {
        *to = row;
    }

    #[inline(always)]
    fn splat(self, value: T) -> [T; WIDTH] {
        [value; WIDTH]
    }

    #[inline(always)]
    fn add(self, mut a: [T; WIDTH], b: [T; WIDTH]) -> [T; WIDTH] {
        for l in 0..WIDTH {
            a[l] = a[l] + b[l];
        }
        a
    }

    #[inline(always)]
    fn mul(self, mut a: [T; WIDTH], b: [T; WIDTH]) -> [T; WIDTH] {
        for l in 0..WIDTH {
            a[l] = a[l] * b[l];
        }
        a
    }

    #[inline(always)]
    fn mul_add(self, mut a: [T; WIDTH], b: [T; WIDTH], c: [T; WIDTH]) -> [T; WIDTH] {
        for l in 0..WIDTH {
            a[l] = a[l].times_plus(b[l], c[l]);
        }
        a
    }

    #[inline(always)]
    fn mul_sub_from(self, mut a: [T; WIDTH], b: [T; WIDTH], c: [T; WIDTH]) -> [T; WIDTH] {
        for l in 0..WIDTH {
            a[l] = (-a[l]).times_plus(b[l], c[l]);
        }
        a
    }
}

/// Single precision in one register of AVX2 with FMA.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(());

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Avx2, Lanes, WIDTH};
    use grainlab_core::instruction_sets::has_avx2;
    use std::arch::x86_64::*;

    impl Avx2 {
        /// None where the processor has no AVX2.
        pub(crate) fn of_processor() -> Option<Self> {
            has_avx2().then_some(Self(()))
        }
    }

    // SAFETY, of all blocks: an `Avx2` is only made where the processor has it.
    impl Lanes for Avx2 {
        type T = f32;
        type Row = __m256;

        #[inline(always)]
        fn load(self, from: &[f32; WIDTH]) -> __m256 {
            unsafe { _mm256_loadu_ps(from.as_ptr()) }
        }

        #[inline(always)]
        fn store(self, row: __m256, to: &mut [f32; WIDTH]) {
            unsafe { _mm256_storeu_ps(to.as_mut_ptr(), row) }
        }

        #[inline(always)]
        fn splat(self, value: f32) -> __m256 {
            unsafe { _mm256_set1_ps(value) }
        }

        #[inline(always)]
        fn add(self, a: __m256, b: __m256) -> __m256 {
            unsafe { _mm256_add_ps(a, b) }
        }

        #[inline(always)]
        fn mul(self, a: __m256, b: __m256) -> __m256 {
            unsafe { _mm256_mul_ps(a, b) }
        }

        #[inline(always)]
        fn mul_add(self, a: __m256, b: __m256, c: __m256) -> __m256 {
            unsafe { _mm256_fmadd_ps(a, b, c) }
        }

        #[inline(always)]
        fn mul_sub_from(self, a: __m256, b: __m256, c: __m256) -> __m256 {
            unsafe { _mm256_fnmadd_ps(a, b, c) }
        }
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    #[test]
    fn avx2_rounds_as_plain_arithmetic_does() {
        let Some(avx2) = Avx2::of_processor() else { return };
        let plain = Plain::<f32>(PhantomData);
        let number = |n: u32| (n as f32 * 0.618_034).sin() * (n as f32 * 0.1).cos().exp();
        for n in 0..2_000 {
            let row = |m: u32| -> [f32; WIDTH] { std::array::from_fn(|l| number(24 * n + 8 * m + l as u32)) };
            let (a, b, c) = (row(0), row(1), row(2));
            let (x, y, z) = (avx2.load(&a), avx2.load(&b), avx2.load(&c));
            let same = |fast, slow: [f32; WIDTH]| {
                let mut stored = [0.0; WIDTH];
                avx2.store(fast, &mut stored);
                assert_eq!(stored.map(f32::to_bits), slow.map(f32::to_bits), "{a:?} {b:?} {c:?}");
            };
            same(avx2.add(x, y), plain.add(a, b));
            same(avx2.mul(x, y), plain.mul(a, b));
            same(avx2.mul_add(x, y, z), plain.mul_add(a, b, c));
            same(avx2.mul_sub_from(x, y, z), plain.mul_sub_from(a, b, c));
            same(avx2.splat(a[3]), plain.splat(a[3]));
        }
    }
}
