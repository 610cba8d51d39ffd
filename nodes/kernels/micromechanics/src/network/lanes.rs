//! Eight columns at once, in either precision; where the processor has them, the compiler makes vector instructions of it.
//!
//! Each operation is rounded in the same way on every processor (a multiply-add once), and no operation mixes
//! columns, so that all instruction sets give the same bits.

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

/// One number of each column.
pub(crate) type Row<T> = [T; WIDTH];

#[inline(always)]
pub(crate) fn splat<T: Real>(value: T) -> Row<T> {
    [value; WIDTH]
}

#[inline(always)]
pub(crate) fn add<T: Real>(mut a: Row<T>, b: Row<T>) -> Row<T> {
    for l in 0..WIDTH {
        a[l] = a[l] + b[l];
    }
    a
}

#[inline(always)]
pub(crate) fn mul<T: Real>(mut a: Row<T>, b: Row<T>) -> Row<T> {
    for l in 0..WIDTH {
        a[l] = a[l] * b[l];
    }
    a
}

#[inline(always)]
pub(crate) fn mul_add<T: Real>(mut a: Row<T>, b: Row<T>, c: Row<T>) -> Row<T> {
    for l in 0..WIDTH {
        a[l] = a[l].times_plus(b[l], c[l]);
    }
    a
}

/// c − a b.
#[inline(always)]
pub(crate) fn mul_sub_from<T: Real>(mut a: Row<T>, b: Row<T>, c: Row<T>) -> Row<T> {
    for l in 0..WIDTH {
        a[l] = (-a[l]).times_plus(b[l], c[l]);
    }
    a
}
