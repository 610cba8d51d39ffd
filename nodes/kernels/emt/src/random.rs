//! Random numbers that a seed repeats.

use nalgebra::SVector;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;

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

    /// In [0, 1), 53 bits.
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }
}
