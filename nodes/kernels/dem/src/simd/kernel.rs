//! Work that is compiled for each instruction set.

use super::simd_f64::SimdF64;

/// Work that can be done in any number of lanes. `run` must be inlined, so that it is compiled for the instruction set.
pub(crate) trait Kernel {
    /// Result of the kernel.
    type Output;
    /// Does the work.
    fn run<L: SimdF64>(self) -> Self::Output;
}
