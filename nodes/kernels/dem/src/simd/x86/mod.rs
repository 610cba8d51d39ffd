//! Four and eight lanes on x86-64 processors.

mod memory;
mod registers;
mod shuffle;

use super::kernel::Kernel;
use registers::{Avx2, Avx512};

/// True if the processor can run [`Avx2`].
pub(crate) fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && has_fma()
}

/// True if the processor has a fused multiply-add.
fn has_fma() -> bool {
    is_x86_feature_detected!("fma")
}

/// True if the processor can run [`Avx512`].
pub(crate) fn has_avx512() -> bool {
    has_avx2()
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

macro_rules! entry {
    ($($what:literal $run:ident $lanes:ty, $features:literal if $has:ident;)*) => {$(
        #[doc = concat!("Runs a kernel with ", $what, ", where the processor can.")]
        pub(crate) fn $run<K: Kernel>(kernel: K) -> Result<K::Output, K> {
            #[target_feature(enable = $features)]
            fn run<K: Kernel>(kernel: K) -> K::Output {
                kernel.run::<$lanes>()
            }
            // SAFETY: the processor was asked.
            if $has() { Ok(unsafe { run(kernel) }) } else { Err(kernel) }
        }
    )*};
}

entry! {
    // Without these a library call does the fused multiply-add.
    "one lane" run_scalar f64, "fma" if has_fma;
    "four lanes" run_avx2 Avx2, "avx2,fma" if has_avx2;
    "eight lanes" run_avx512 Avx512, "avx2,fma,avx512f,avx512dq,avx512vl" if has_avx512;
}
