//! Choosing an instruction set at run time.

use super::kernel::{InLanes, Kernel};
#[cfg(target_arch = "x86_64")]
use super::x86::{Avx2, Avx512};
use grainlab_core::instruction_sets::{has_avx2, has_avx512, with_avx2, with_avx512, with_fma};
use std::fmt;
use std::marker::PhantomData;
use std::str::FromStr;

/// An instruction set for the force kernel. All give the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Simd {
    /// One contact at a time, on any processor.
    Scalar,
    /// Four at a time.
    Avx2,
    /// Eight at a time.
    Avx512,
}

impl Simd {
    /// All instruction sets, from narrow to wide.
    pub const ALL: [Simd; 3] = [Simd::Scalar, Simd::Avx2, Simd::Avx512];

    /// True if this processor has the instruction set.
    pub fn is_available(self) -> bool {
        match self {
            Simd::Scalar => true,
            Simd::Avx2 => has_avx2(),
            Simd::Avx512 => has_avx512(),
        }
    }

    /// Returns this instruction set.
    ///
    /// # Errors
    /// A processor that lacks it.
    pub fn if_available(self) -> Result<Simd, UnavailableSimd> {
        if self.is_available() { Ok(self) } else { Err(UnavailableSimd(self)) }
    }

    /// The instruction sets of this processor, from narrow to wide.
    pub fn available() -> Vec<Simd> {
        Self::ALL.into_iter().filter(|s| s.is_available()).collect()
    }

    /// The widest instruction set of this processor.
    pub fn best() -> Simd {
        Self::ALL.into_iter().rfind(|s| s.is_available()).unwrap_or(Simd::Scalar)
    }

    /// Lanes of 64-bit floats.
    pub fn width(self) -> usize {
        match self {
            Simd::Scalar => 1,
            Simd::Avx2 => 4,
            Simd::Avx512 => 8,
        }
    }

    /// Runs a kernel. Where the processor lacks this set it runs with one lane, with the same bits.
    #[inline]
    pub(crate) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        #[cfg(target_arch = "x86_64")]
        let kernel = {
            let tried = match self {
                Simd::Scalar => Err(kernel),
                Simd::Avx2 => with_avx2(InLanes::<K, Avx2>(kernel, PhantomData)).map_err(|work| work.0),
                Simd::Avx512 => with_avx512(InLanes::<K, Avx512>(kernel, PhantomData)).map_err(|work| work.0),
            };
            match tried.or_else(|kernel| with_fma(InLanes::<K, f64>(kernel, PhantomData))) {
                Ok(output) => return output,
                Err(work) => work.0,
            }
        };
        kernel.run::<f64>()
    }
}

impl fmt::Display for Simd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Simd::Scalar => "scalar",
            Simd::Avx2 => "avx2",
            Simd::Avx512 => "avx512",
        })
    }
}

/// An instruction set that this processor lacks.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("this processor has no {0}; it has {available}", available = names(&Simd::available()))]
pub struct UnavailableSimd(Simd);

fn names(sets: &[Simd]) -> String {
    sets.iter().map(Simd::to_string).collect::<Vec<_>>().join(", ")
}

/// The name of no instruction set.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown instruction set \"{0}\"; known are scalar, avx2 and avx512")]
pub struct UnknownSimd(String);

impl FromStr for Simd {
    type Err = UnknownSimd;

    fn from_str(text: &str) -> Result<Self, UnknownSimd> {
        Self::ALL.into_iter().find(|s| s.to_string() == text).ok_or_else(|| UnknownSimd(text.to_owned()))
    }
}
