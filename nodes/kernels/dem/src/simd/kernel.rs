//! Work that is compiled for each instruction set.

use super::simd_f64::SimdF64;
use grainlab_core::instruction_sets::Work;
use std::marker::PhantomData;

/// Work that can be done in any number of lanes. `run` must be inlined, so that it is compiled for the instruction set.
pub(crate) trait Kernel {
    type Output;
    fn run<L: SimdF64>(self) -> Self::Output;
}

pub(super) struct InLanes<K, L>(pub(super) K, pub(super) PhantomData<L>);

impl<K: Kernel, L: SimdF64> Work for InLanes<K, L> {
    type Output = K::Output;

    #[inline(always)]
    fn run(self) -> K::Output {
        self.0.run::<L>()
    }
}
