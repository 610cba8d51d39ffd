//! The most that one core can do: multiplications and additions on registers, nothing else.

use crate::commands::bench::cpu_time::thread_seconds;
use crate::failure::Failure;
use dem::Simd;
use std::hint::black_box;

/// Registers that are worked on in turn: enough to hide the latency of one.
const CHAINS: usize = 10;
/// Rounds of one measurement, some milliseconds.
const ROUNDS: usize = 1_000_000;
/// The best of these is the peak: a shared core only ever slows one down.
const MEASUREMENTS: usize = 10;

/// Flops per second of one core with this instruction set; `None` where there is no loop for it.
pub(crate) fn peak(set: Simd) -> Result<Option<f64>, Failure> {
    let Some((multiply_add, lanes)) = chosen(set) else { return Ok(None) };
    let flops = (2 * lanes * CHAINS * ROUNDS) as f64;
    let mut best = 0.0f64;
    for _ in 0..MEASUREMENTS {
        let begin = thread_seconds()?;
        black_box(multiply_add(black_box(0.999_999), black_box(1e-6)));
        best = best.max(flops / (thread_seconds()? - begin));
    }
    Ok(Some(best))
}

type MultiplyAdd = fn(f64, f64) -> f64;

#[cfg(target_arch = "x86_64")]
fn chosen(set: Simd) -> Option<(MultiplyAdd, usize)> {
    if !set.is_available() {
        return None;
    }
    // SAFETY: the processor was just asked for the features; AVX2 here always comes with FMA, which is asked for below.
    match set {
        Simd::Scalar => Some((|a, b| unsafe { x86::sse2(a, b) }, 2)),
        Simd::Avx2 => is_x86_feature_detected!("fma").then_some((|a, b| unsafe { x86::avx2(a, b) }, 4)),
        Simd::Avx512 => Some((|a, b| unsafe { x86::avx512(a, b) }, 8)),
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn chosen(_: Simd) -> Option<(MultiplyAdd, usize)> {
    None
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{CHAINS, ROUNDS};
    use std::arch::x86_64::*;

    macro_rules! multiply_add {
        ($(#[$what:meta])* $name:ident, $feature:literal, $set1:ident, $first:ident, |$x:ident, $a:ident, $b:ident| $step:expr) => {
            $(#[$what])*
            #[target_feature(enable = $feature)]
            pub(super) fn $name(a: f64, b: f64) -> f64 {
                let ($a, $b) = ($set1(a), $set1(b));
                let mut chains: [_; CHAINS] = std::array::from_fn(|k| $set1(k as f64));
                for _ in 0..ROUNDS {
                    for chain in &mut chains {
                        let $x = *chain;
                        *chain = $step;
                    }
                }
                chains.iter().map(|c| $first(*c)).sum()
            }
        };
    }

    multiply_add!(
        /// Two lanes, a multiplication and an addition: what every x86-64 has.
        sse2, "sse2", _mm_set1_pd, _mm_cvtsd_f64, |x, a, b| _mm_add_pd(_mm_mul_pd(x, a), b)
    );
    multiply_add!(
        /// Four lanes, fused.
        avx2, "avx2,fma", _mm256_set1_pd, _mm256_cvtsd_f64, |x, a, b| _mm256_fmadd_pd(x, a, b)
    );
    multiply_add!(
        /// Eight lanes, fused.
        avx512, "avx512f", _mm512_set1_pd, _mm512_cvtsd_f64, |x, a, b| _mm512_fmadd_pd(x, a, b)
    );
}
