//! Work compiled for the wider instruction sets of x86-64, which runs where the processor has them.

/// Work that is compiled for each instruction set.
pub trait Work {
    /// Result of the work.
    type Output;
    /// Does the work. It and all that it calls must be `#[inline(always)]`: else they use the baseline instruction set.
    fn run(self) -> Self::Output;
}

macro_rules! sets {
    ($($what:literal $has:ident $run:ident: [$($feature:tt)*];)*) => {$(
        #[doc = concat!("True if the processor has ", $what, ".")]
        pub fn $has() -> bool {
            #[cfg(target_arch = "x86_64")]
            return $(is_x86_feature_detected!($feature))&&*;
            #[cfg(not(target_arch = "x86_64"))]
            false
        }

        #[doc = concat!("Runs the work with ", $what, ".\n\n# Errors\nThe work itself, where the processor has none.")]
        pub fn $run<W: Work>(work: W) -> Result<W::Output, W> {
            #[cfg_attr(target_arch = "x86_64", target_feature($(enable = $feature),*))]
            fn run<W: Work>(work: W) -> W::Output {
                work.run()
            }
            // SAFETY: the processor was asked.
            #[allow(unused_unsafe, reason = "on other processors")]
            if $has() { Ok(unsafe { run(work) }) } else { Err(work) }
        }
    )*};
}

sets! {
    // A library call does a fused multiply-add elsewhere.
    "a fused multiply-add" has_fma with_fma: ["fma"];
    "AVX2" has_avx2 with_avx2: ["avx2" "fma"];
    "AVX-512 F, DQ and VL" has_avx512 with_avx512: ["avx2" "fma" "avx512f" "avx512dq" "avx512vl"];
}
