//! Instruction sets: the same arithmetic in one, four or eight lanes.
//!
//! - `simd_f64`: lanes with access to blocks of pairs and tables of grains
//! - `scalar`, `x86`: the widths
//! - `kernel`, `instruction_set`: work compiled for each, and the choice at run time

pub(crate) mod instruction_set;
pub(crate) mod kernel;
mod scalar;
pub(crate) mod simd_f64;
#[cfg(target_arch = "x86_64")]
mod x86;
