//! The peak performance of one core.

use crate::cpu_time::thread_seconds;
use grainlab_console::Failure;
use grainlab_dem::{Simd, roofline};
use std::hint::black_box;

/// Rounds of one measurement, some milliseconds.
const ROUNDS: u64 = 1_000_000;
/// Number of measurements, of which the best is the peak: other load on a shared core only slows it down.
const MEASUREMENTS: usize = 10;

/// Operations per second of one core with this instruction set, by CPU time.
pub(crate) fn peak(set: Simd) -> Result<f64, Failure> {
    let mut best = 0.0f64;
    for _ in 0..MEASUREMENTS {
        let begin = thread_seconds()?;
        let (operations, _) = black_box(roofline::peak_flops(set, black_box(ROUNDS)));
        best = best.max(operations as f64 / (thread_seconds()? - begin));
    }
    Ok(best)
}
