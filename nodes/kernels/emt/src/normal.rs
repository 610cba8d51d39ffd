//! The standard normal distribution, χ², and random numbers.

use nalgebra::SVector;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// ln(2π)/2.
pub(crate) const LN_SQRT_TAU: f64 = 0.918_938_533_204_672_7;

/// ln of the normal density of this mean and standard deviation.
pub(crate) fn ln_density(x: f64, mean: f64, stddev: f64) -> f64 {
    -0.5 * ((x - mean) / stddev).powi(2) - stddev.ln() - LN_SQRT_TAU
}

/// Probability below x.
pub(crate) fn below(x: f64) -> f64 {
    0.5 * libm::erfc(-x * FRAC_1_SQRT_2)
}

/// The x below which the probability is `p`; infinite for 0 and 1. Acklam's rational approximation, and one step of Halley's
/// method: accurate to rounding.
pub(crate) fn quantile(p: f64) -> f64 {
    const A: [f64; 6] = [
        -3.969_683_028_665_376e1,
        2.209_460_984_245_205e2,
        -2.759_285_104_469_687e2,
        1.383_577_518_672_69e2,
        -3.066_479_806_614_716e1,
        2.506_628_277_459_239,
    ];
    const B: [f64; 6] = [
        -5.447_609_879_822_406e1,
        1.615_858_368_580_409e2,
        -1.556_989_798_598_866e2,
        6.680_131_188_771_972e1,
        -1.328_068_155_288_572e1,
        1.0,
    ];
    const C: [f64; 6] = [
        -7.784_894_002_430_293e-3,
        -3.223_964_580_411_365e-1,
        -2.400_758_277_161_838,
        -2.549_732_539_343_734,
        4.374_664_141_464_968,
        2.938_163_982_698_783,
    ];
    const D: [f64; 5] = [
        7.784_695_709_041_462e-3,
        3.224_671_290_700_398e-1,
        2.445_134_137_142_996,
        3.754_408_661_907_416,
        1.0,
    ];
    if p <= 0.0 || p >= 1.0 {
        return if p <= 0.0 { f64::NEG_INFINITY } else { f64::INFINITY };
    }
    let polynomial = |c: &[f64], x: f64| c.iter().fold(0.0, |sum, c| sum * x + c);
    let tail = |p: f64| {
        let q = (-2.0 * p.ln()).sqrt();
        polynomial(&C, q) / polynomial(&D, q)
    };
    let x = if p < 0.024_25 {
        tail(p)
    } else if p > 1.0 - 0.024_25 {
        -tail(1.0 - p)
    } else {
        let q = p - 0.5;
        q * polynomial(&A, q * q) / polynomial(&B, q * q)
    };
    let off = (below(x) - p) * (0.5 * x * x + LN_SQRT_TAU).exp();
    x - off / (1.0 + 0.5 * x * off)
}

/// Probability that χ² with so many degrees of freedom, 1 or more, exceeds this value.
pub(crate) fn chi_square_above(chi_square: f64, degrees_of_freedom: usize) -> f64 {
    let half = 0.5 * chi_square.max(0.0);
    // Each two degrees of freedom add a term.
    let (mut probability, mut term, first) = if degrees_of_freedom.is_multiple_of(2) {
        (0.0, (-half).exp(), 1.0)
    } else {
        (libm::erfc(half.sqrt()), 2.0 * (half / std::f64::consts::PI).sqrt() * (-half).exp(), 1.5)
    };
    for i in 0..degrees_of_freedom / 2 {
        probability += term;
        term *= half / (first + i as f64);
    }
    probability.min(1.0)
}

/// Random numbers that a seed repeats.
pub(crate) struct Random(Pcg64Mcg);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    /// Independent numbers of mean 0 and variance 1.
    pub(crate) fn normal<const N: usize>(&mut self) -> SVector<f64, N> {
        let mut v = SVector::zeros();
        for pair in 0..N.div_ceil(2) {
            let (first, second) = self.pair();
            v[2 * pair] = first;
            if 2 * pair + 1 < N {
                v[2 * pair + 1] = second;
            }
        }
        v
    }

    /// Two of them, by Box and Muller's method.
    fn pair(&mut self) -> (f64, f64) {
        // In (0, 1], where the logarithm is finite.
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        let (sin, cos) = (TAU * self.uniform()).sin_cos();
        (radius * cos, radius * sin)
    }

    /// For a generator of its own.
    pub(crate) fn next_seed(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// In [0, 1), 53 bits.
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_and_probabilities_are_those_of_tables() {
        for (x, p) in [(1.959_963_984_540_054, 0.975), (-3.090_232_306_167_813, 1e-3), (0.0, 0.5)] {
            assert!((quantile(p) - x).abs() < 1e-14 && (below(x) - p).abs() < 1e-15, "{p}");
        }
        for p in [1e-300, 1e-20, 0.02, 0.3, 0.98, 1.0 - 1e-12] {
            assert!((below(quantile(p)) / p - 1.0).abs() < 1e-10, "{p}");
        }
    }

    #[test]
    fn chi_square_is_exceeded_as_tables_say() {
        for (chi_square, freedom, p) in [
            (3.841_458_821, 1, 0.05),
            (5.991_464_547, 2, 0.05),
            (16.266_236_196, 3, 1e-3),
            (30.143_527_206, 19, 0.05),
        ] {
            assert!((chi_square_above(chi_square, freedom) / p - 1.0).abs() < 1e-8, "{freedom}");
        }
        assert_eq!([1, 2, 7].map(|n| chi_square_above(0.0, n)), [1.0; 3]);
    }
}
