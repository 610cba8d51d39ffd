//! Powers with any exponent, in lanes.

use crate::lanes::{Lanes, WHOLE};
use std::f64::consts::{LN_2, SQRT_2};

/// Series of artanh(s)/s in s².
const ARTANH: [f64; 11] = [
    1.0,
    1.0 / 3.0,
    1.0 / 5.0,
    1.0 / 7.0,
    1.0 / 9.0,
    1.0 / 11.0,
    1.0 / 13.0,
    1.0 / 15.0,
    1.0 / 17.0,
    1.0 / 19.0,
    1.0 / 21.0,
];

/// Series of e^x in x.
const EXP: [f64; 14] = [
    1.0,
    1.0,
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];

/// A loop, because a closure would not be compiled for the instruction set of its caller.
#[inline(always)]
fn series<L: Lanes, const N: usize>(x: L, coefficients: &[f64; N]) -> L {
    let mut sum = L::splat(coefficients[N - 1]);
    let mut k = N - 1;
    while k > 0 {
        k -= 1;
        sum = sum.mul_add(x, L::splat(coefficients[k]));
    }
    sum
}

/// `base`^`exponent` for a positive base and a result below 2^1023, to 1e-14 where its logarithm is below 30; at least
/// 2^-1022, and exact for a base of 1. The bits are the same in every width and on every processor, unlike those of `powf`.
#[inline(always)]
pub(crate) fn power<L: Lanes>(base: L, exponent: L) -> L {
    let one = L::splat(1.0);
    let (e, m) = base.split();
    let above = m.gt(L::splat(SQRT_2));
    let (e, m) = (L::select(above, e + one, e), L::select(above, L::splat(0.5) * m, m));
    // ln m = 2 artanh s
    let s = (m - one) / (m + one);
    let log2 = (s * series(s * s, &ARTANH)).mul_add(L::splat(2.0 / LN_2), e);
    let log2 = (exponent * log2).max(L::splat(-1022.0));
    // The sum has no room for a fraction.
    let whole = (log2 + L::splat(1.5 * WHOLE)) - L::splat(1.5 * WHOLE);
    series((log2 - whole) * L::splat(LN_2), &EXP) * whole.power_of_two()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_is_that_of_the_library() {
        for k in -200..200 {
            for exponent in [0.583, 1.5898, -1.5, 0.0, 1.0] {
                let base = 1.1f64.powi(k);
                assert!(
                    (power(base, exponent) / base.powf(exponent) - 1.0).abs() < 1e-14,
                    "{base} {exponent}"
                );
            }
        }
        assert_eq!((power(1.0, 1.7), power(0.0, 0.5) < 1e-150), (1.0, true));
    }
}
