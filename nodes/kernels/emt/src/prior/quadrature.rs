//! Integrals over a normal density between two limits.

use crate::normal::LN_SQRT_TAU;
use std::sync::LazyLock;

/// A density multiplied by a normal one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tilted {
    /// ln of the integral of the product.
    pub(crate) ln_mass: f64,
    pub(crate) mean: f64,
    pub(crate) variance: f64,
}

/// Number of nodes: over 18 standard deviations the moments are accurate to 1e-13.
const NODES: usize = 64;

/// Drop of the logarithm of the density beyond which it does not matter.
const DROP: f64 = 40.0;

/// Nodes and weights of Gauss and Legendre on [−1, 1].
static RULE: LazyLock<[(f64, f64); NODES]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let n = NODES as f64;
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..100 {
            let (mut previous, mut current) = (1.0, x);
            for k in 2..=NODES {
                let k = k as f64;
                (previous, current) = (current, ((2.0 * k - 1.0) * x * current - (k - 1.0) * previous) / k);
            }
            slope = n * (x * current - previous) / (x * x - 1.0);
            let step = current / slope;
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    })
});

/// Integral, mean and variance of a normal density between two limits. Accurate also far in its tail.
pub(super) fn integrated(mean: f64, stddev: f64, [low, high]: [f64; 2]) -> Tilted {
    let highest = mean.clamp(low, high);
    let off = (highest - mean) / stddev;
    let reach = stddev * (off * off + 2.0 * DROP).sqrt();
    let (from, to) = (low.max(mean - reach), high.min(mean + reach));
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let mut sums = [0.0; 3];
    for (x, weight) in *RULE {
        // From the middle, and in units of the half width, so that no digits are lost.
        let z = (middle + half * x - mean) / stddev;
        let density = weight * (0.5 * (off * off - z * z)).exp();
        sums[0] += density;
        sums[1] += density * x;
        sums[2] += density * x * x;
    }
    let (first, second) = (sums[1] / sums[0], sums[2] / sums[0]);
    Tilted {
        ln_mass: (sums[0] * half / stddev).ln() - 0.5 * off * off - LN_SQRT_TAU,
        mean: middle + half * first,
        variance: half * half * (second - first * first),
    }
}
